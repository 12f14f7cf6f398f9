"""`elbowroom evaluate plan`: how fast the figures of a plan follow the hand."""

from typing import Annotated, Any

import typer

from elbowroom.cli.options import JsonFile

QUICK_TIMES = 3


def plan(
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_TIMES} times of each are enough.")] = False,
    json: JsonFile = None,
) -> None:
    """Measure how long it takes from a drag to the figures of `elbowroom plan`, first and exact.

    In the simulated room and the thesis' room, 21 cameras: a camera dragged, a person
    moved, a joint moved.
    """
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import print_
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.plan.measured import DUE, TIMES, plan_rows

    def show(found: Any) -> None:
        for row in found:
            print_(
                f"{row['room']}, {row['deed']} moved: first figures after {row['coarse_ms']:.0f} ms "
                f"(worst {row['coarse_worst_ms']:.0f}), exact ones after {row['exact_ms']:.0f} ms "
                f"(worst {row['exact_worst_ms']:.0f})"
            )
        print_(sentence(DUE))

    measured("deeds", told(lambda tell: plan_rows(QUICK_TIMES if quick else TIMES, tell)), None, json, show)
