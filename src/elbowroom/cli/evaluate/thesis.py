"""`elbowroom evaluate reconstruction`, `motions`, `calibration`, `scale`, `more`, `all`: the thesis' experiments."""

import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from elbowroom.cli.evaluate.options import Cameras, Cluster, Jobs, Out, VoxelSizes
from elbowroom.cli.options import JsonFile

SetupNumbers = Annotated[
    list[int] | None, typer.Option("--setup", min=1, max=6, help="Of the six; may be given more than once.")
]
Sensors = Annotated[
    list[str] | None,
    typer.Option("--sensor", help="640x480 or 64x48; may be given more than once. Default: both."),
]
Draws = Annotated[int, typer.Option(min=1, help="Disturbed poses at each size of error.")]
RandomMotions = Annotated[
    int, typer.Option("--motions", min=0, help="Random motions whose truth is within L.")
]
Pictures = Annotated[bool, typer.Option(help="Draw pictures.")]
Page = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for report.html and what is kept.")]
WHERE = {"out": Out, "jobs": Jobs, "cluster": Cluster, "json": JsonFile}
"""Options that all of these commands have: where the work goes and what it leaves."""
Asked = Mapping[str, Any]
"""What a command asks for, by the names of `Settings`; what is None is as usual."""


def experiment(asked: Callable[..., Asked]) -> Callable[..., None]:
    """A command that does the part of its name, or all; `WHERE` comes to its options where it has not its own.

    Args:
        asked: the command's own options in, what is asked for out.
    """
    own = inspect.signature(asked).parameters
    more = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=option)
        for name, option in WHERE.items()
        if name not in own
    ]

    @wraps(asked)
    def command(**given: Any) -> None:
        from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings
        from elbowroom.evaluate.thesis.parts import PARTS

        name = asked.__name__
        parts = tuple(PARTS.values()) if name == all_parts.__name__ else (PARTS[name],)
        wanted = settings(**asked(**{name: given[name] for name in own}))
        run_parts(parts, wanted, Spread(given["jobs"], given["cluster"]), given["out"], given["json"])

    every = [*(one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in own.values()), *more]
    command.__signature__ = inspect.Signature(every)  # type: ignore[attr-defined]
    command.__annotations__ = {one.name: one.annotation for one in every}
    return command


@experiment
def reconstruction(
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    sensor: Sensors = None,
    cameras: Cameras = 21,
    pictures: Pictures = True,
) -> Asked:
    """Each voxel of the thesis' six setups beside the truth (its Tables 1 and 2, Fig. 9)."""
    return {
        "setups": setup,
        "voxel_sizes_m": voxel_size,
        "sensors": sensor,
        "cameras": cameras,
        "pictures": pictures,
    }


@experiment
def motions(
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    sensor: Sensors = None,
    motions: RandomMotions = 500,
    cameras: Cameras = 21,
) -> Asked:
    """The thesis' 35 movements, and random ones, beside exact geometry (its Tables 3 and 4)."""
    return {
        "setups": setup,
        "voxel_sizes_m": voxel_size,
        "sensors": sensor,
        "random_motions": motions,
        "cameras": cameras,
    }


@experiment
def calibration(
    setup: SetupNumbers = None, voxel_size: VoxelSizes = None, draws: Draws = 50, cameras: Cameras = 21
) -> Asked:
    """Cameras that are not quite where they are said to be (thesis 6.1.2), with a declared margin and without."""
    return {"setups": setup or [1], "voxel_sizes_m": voxel_size, "draws": draws, "cameras": cameras}


@experiment
def scale(voxel_size: VoxelSizes = None) -> Asked:
    """A simulated model of the room at 1:5 with four Kinects (thesis 5.2, 6.2): free travel beside the truth."""
    return {"voxel_sizes_m": voxel_size}


@experiment
def more(setup: SetupNumbers = None) -> Asked:
    """What else the thesis claims: more sensors give more freedom, small objects are missed, its Fig. 3."""
    return {"setups": setup or [1]}


@experiment
def all_parts(
    out: Page,
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    draws: Draws = 50,
    motions: RandomMotions = 500,
) -> Asked:
    """All of the thesis' experiments, as one page beside the thesis' own figures.

    Ctrl-C keeps what is finished; the same command goes on from there.
    """
    return {"setups": setup, "voxel_sizes_m": voxel_size, "draws": draws, "random_motions": motions}
