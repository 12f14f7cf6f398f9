"""Options of `elbowroom simulate`, and those that other simulated recordings share."""

from pathlib import Path
from typing import Annotated, Literal

import typer

Size = Literal["vga", "qqvga", "thesis"]
ImageSize = Annotated[Size, typer.Option(help="Of their images.")]
MeshUp = Annotated[
    Literal["x", "y", "z"] | None,
    typer.Option("--up", help="Axis of the file that points up. Default: what it says; of GLB y, else z."),
]
MeshUnit = Annotated[
    float | None,
    typer.Option(
        "--unit", min=1e-6, metavar="METRES", help="Of one unit of the file. Default: what it says, else 1."
    ),
]
Noise = Annotated[str, typer.Option(help="exact, or a sensor such as tof, kinect_v1.")]

OptionalSite = Annotated[
    Path | None,
    typer.Argument(
        metavar="SITE",
        help="A site file: its own machine, cameras, lenses, noise and grid, and its key room. Without it: cameras "
        "along the walls, and the ceiling C-arm.",
    ),
]
RoomFile = Annotated[
    str | None,
    typer.Option("--room", metavar="GLB", help="A room of closed solids as GLB, or setup1 to setup6."),
]
OutFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Folder for images and site.yaml. With SITE it may be left out: images go to where the site's "
        "recording lies.",
    ),
]
Moments = Annotated[
    int | None, typer.Option(min=1, max=100_000, help="How many. Default: 20 with SITE, else 1.")
]
Rate = Annotated[float, typer.Option(min=0.01, max=1000.0, help="Moments a second.")]
Moving = Annotated[
    list[str] | None,
    typer.Option(metavar="person", help="Who walks past the machine; may be given once for each of several."),
]
Still = Annotated[
    bool, typer.Option("--still", help="The machine stands still; else it swings about its pose.")
]
OptionalNoise = Annotated[
    str | None,
    typer.Option(
        help="exact, or a sensor such as tof, realsense_d435. Default: as the site says, else exact."
    ),
]
Seed = Annotated[int, typer.Option(min=0, help="Of noise, and of a pose that is looked for.")]
Truth = Annotated[
    bool, typer.Option("--truth", help="Also write which voxels are truly occupied, to DIR/truth.")
]

WallCameras = Annotated[
    int | None,
    typer.Option(min=1, max=200, help="Without SITE: how many, along the walls of the box. Default: 21."),
]
WallSize = Annotated[Size | None, typer.Option(help="Without SITE: of their images. Default: vga.")]
WallHeights = Annotated[
    list[float] | None,
    typer.Option(
        metavar="METRES", help="Without SITE: of the cameras; several: in turn. Default: 2.4 and 0.4."
    ),
]
WallBox = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y,Z,X,Y,Z",
        help="Without SITE: the watched box, its least and greatest corner, in metres. Default: -2,-2,0,2,2,2.5.",
    ),
]
WallVoxel = Annotated[
    float | None,
    typer.Option(
        "--voxel-size",
        metavar="METRES",
        help="Without SITE: edge of a voxel in the site file. Default: 0.05.",
    ),
]
WallMachine = Annotated[
    bool | None,
    typer.Option("--machine/--no-machine", help="Without SITE: with the ceiling C-arm in the room, or not."),
]
