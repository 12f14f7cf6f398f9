"""`elbowroom evaluate hand`: a hand at arms whose collision geometry is larger than they are."""

from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Cameras, Seed, Size
from elbowroom.cli.options import JsonFile

Scenes = Annotated[int, typer.Option(min=1, metavar="COUNT", help="How many poses and hands for each arm.")]
Own = Annotated[
    bool,
    typer.Option(
        "--own",
        help="Our own four arms alone; else also four published ones, of the package example-robot-data.",
    ),
]


def hand(
    scenes: Scenes = 40,
    cameras: Cameras = 12,
    size: Size = "vga",
    own: Own = False,
    seed: Seed = 3,
    json: JsonFile = None,
) -> None:
    """Check motions that meet a hand close to an arm, which lies within the arm's collision geometry or beside it.

    A ball of 5 cm within 1 cm of the arm; motions that meet it within the braking distance must not be clear. Explained
    by visual geometry, and by the collision geometry that is swept; with the noise of a time-of-flight camera.
    Four arms are of boxes; four are published ones, swept by the convex hulls of what is seen of their links.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.hand.arms import ARMS
    from elbowroom.evaluate.hand.hand import DUE, EVERY, hand_rows, hand_summary
    from elbowroom.evaluate.hand.published import robots_folder

    if not own:
        robots_folder()  # missing, that is said before anything is measured
    columns = {"explained by": "{explain_with}", "noise": "{noise}"}
    counts = ("motions", "in_excess", "stop", "decelerate", "inform", "clear")
    alone = {"alone, stop": "{alone_stop_pct:.1f} %"}
    show = as_table(
        {**columns, **{name.replace("_", " "): f"{{{name}}}" for name in counts}, **alone},
        sentence(DUE, "of each way of explaining"),
    )
    rows = hand_rows(tuple(ARMS) if own else EVERY, scenes=scenes, cameras=cameras, size=size, seed=seed)
    measured("verdicts", rows, None, json, show, hand_summary)
