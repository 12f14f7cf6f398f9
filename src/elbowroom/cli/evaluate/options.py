"""Options that several evaluations share."""

from pathlib import Path
from typing import Annotated, Literal

import typer

Poses = Annotated[int, typer.Option(min=1, metavar="COUNT", help="How many random poses.")]
Cameras = Annotated[int, typer.Option(min=1, max=255, help="How many cameras, along the walls.")]
Size = Annotated[Literal["vga", "qqvga", "thesis"], typer.Option(help="Of their images.")]
Seed = Annotated[int, typer.Option(min=0, help="Of the random poses; the same seed gives the same poses.")]
VoxelSizes = Annotated[
    list[float] | None,
    typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel; may be given more than once."),
]
OneVoxelSize = Annotated[float, typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel.")]
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
