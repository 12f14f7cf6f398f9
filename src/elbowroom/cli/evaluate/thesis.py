"""`elbowroom evaluate reconstruction`, `motions`, `calibration`, `scale`, `more`, `all`: the thesis' experiments."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.evaluate.app import VoxelSizes, evaluate_app
from elbowroom.cli.options import JsonFile

Out = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Folder for the page; what is done is kept there, so that one can go on."
    ),
]
Jobs = Annotated[int | None, typer.Option(min=1, help="Processes on this computer. Default: one a core.")]
Cluster = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="A Dask scheduler that spreads the work, tcp://HOST:PORT."),
]
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
Cameras = Annotated[int, typer.Option(min=1, max=255, help="How many, along the walls.")]
Pictures = Annotated[bool, typer.Option(help="Draw pictures.")]


@evaluate_app.command(
    epilog="Example: elbowroom evaluate reconstruction --setup 1 --voxel-size 0.1 --json out.json"
)
def reconstruction(
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    sensor: Sensors = None,
    cameras: Cameras = 21,
    pictures: Pictures = True,
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """Each voxel of the thesis' six setups beside the truth (its Tables 1 and 2, Fig. 9)."""
    from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings

    given = settings(
        setups=setup, voxel_sizes_m=voxel_size, sensors=sensor, cameras=cameras, pictures=pictures
    )
    run_parts(("reconstruction",), given, Spread(jobs, cluster), out, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate motions --motions 100 --json motions.json")
def motions(
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    sensor: Sensors = None,
    motions: RandomMotions = 500,
    cameras: Cameras = 21,
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """The thesis' 35 movements, and random ones, beside exact geometry (its Tables 3 and 4)."""
    from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings

    given = settings(
        setups=setup, voxel_sizes_m=voxel_size, sensors=sensor, random_motions=motions, cameras=cameras
    )
    run_parts(("motions",), given, Spread(jobs, cluster), out, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate calibration --draws 10 --json calibration.json")
def calibration(
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    draws: Draws = 50,
    cameras: Cameras = 21,
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """Cameras that are not quite where they are said to be (thesis 6.1.2), with a declared margin and without."""
    from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings

    given = settings(setups=setup or [1], voxel_sizes_m=voxel_size, draws=draws, cameras=cameras)
    run_parts(("calibration",), given, Spread(jobs, cluster), out, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate scale --json scale.json")
def scale(
    voxel_size: VoxelSizes = None,
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """A simulated model of the room at 1:5 with four Kinects (thesis 5.2, 6.2): free travel beside the truth."""
    from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings

    run_parts(("scale",), settings(voxel_sizes_m=voxel_size), Spread(jobs, cluster), out, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate more --out report --json more.json")
def more(
    setup: SetupNumbers = None,
    out: Out = None,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """What else the thesis claims: more sensors give more freedom, small objects are missed, its Fig. 3."""
    from elbowroom.cli.evaluate.thesis_run import Spread, run_parts, settings

    run_parts(("more",), settings(setups=setup or [1]), Spread(jobs, cluster), out, json)


@evaluate_app.command(name="all", epilog="Example: elbowroom evaluate all --out report --json report.json")
def all_parts(
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder for report.html and what is kept.")
    ],
    setup: SetupNumbers = None,
    voxel_size: VoxelSizes = None,
    draws: Draws = 50,
    motions: RandomMotions = 500,
    jobs: Jobs = None,
    cluster: Cluster = None,
    json: JsonFile = None,
) -> None:
    """All of the thesis' experiments, as one page beside the thesis' own figures.

    Ctrl-C keeps what is finished; the same command goes on from there.
    """
    from elbowroom.cli.evaluate.thesis_run import PARTS, Spread, run_parts, settings

    given = settings(setups=setup, voxel_sizes_m=voxel_size, draws=draws, random_motions=motions)
    run_parts(tuple(PARTS), given, Spread(jobs, cluster), out, json)
