"""Options of `elbowroom calibrate simulate`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

Kind = Annotated[
    Literal["board", "machine", "room"],
    typer.Argument(help="board: held up all over the room; machine: in many poses; room: still, at 30 Hz."),
]
Out = Annotated[Path, typer.Option(metavar="DIR", help="Folder for images, site.yaml and truth.yaml.")]
AlongWalls = Annotated[int, typer.Option(min=1, max=200, help="How many, along the walls.")]
Poses = Annotated[
    int | None,
    typer.Option(min=2, help="Of board or machine, or moments of the room. Default: 40, 12, 30."),
]
BoardKind = Annotated[
    Literal["cut_out", "printed"],
    typer.Option(help="cut_out: seen in depth images; printed: in infrared images."),
]
Corners = Annotated[
    str | None,
    typer.Option(metavar="COLUMNSxROWS", help="Inner corners. Default: 8x5; 64x48 images: 5x4."),
]
Square = Annotated[
    float | None,
    typer.Option(metavar="METRES", help="Edge of a square. Default: 0.1; 64x48 images: 0.18."),
]
Border = Annotated[float, typer.Option(metavar="METRES", help="Around the squares.")]
Stands = Annotated[
    int | None,
    typer.Option(
        min=0,
        help="So many of the poses are on stands, where corners were measured to 2 mm, which fixes the world; 0: "
        "one is on the floor. Default: 0; 64x48 images, which show no board on the floor: 10.",
    ),
]
WrongDeg = Annotated[float, typer.Option(help="The site's poses are turned by so many degrees.")]
WrongM = Annotated[float, typer.Option(help="The site's poses are moved by so many metres.")]
Focal = Annotated[float, typer.Option(metavar="PERCENT", help="True focal lengths differ by up to this.")]
Lens = Annotated[bool, typer.Option("--lens", help="True lenses bend; the site knows nothing of it.")]
DepthScale = Annotated[float, typer.Option(metavar="PERCENT", help="Depth is too long by up to this.")]
DepthBias = Annotated[float, typer.Option(metavar="METRES", help="And by up to this.")]
Near = Annotated[
    bool,
    typer.Option(
        "--near", help="The board right before one camera after the other, for intrinsics; 20 poses each."
    ),
]
Hand = Annotated[
    float,
    typer.Option(
        metavar="METRES", help="A hand moves the board so far from one camera's exposure to another's."
    ),
]
MovedPose = Annotated[
    int | None, typer.Option(min=1, help="In this pose the board is moved on by 3 cm in between.")
]
Knock = Annotated[
    str | None, typer.Option(metavar="CAMERA", help="This camera was knocked after the site was written.")
]
KnockDeg = Annotated[float, typer.Option(help="It is turned by so many degrees.")]
KnockM = Annotated[float, typer.Option(help="It is moved by so many metres.")]
Seed = Annotated[int, typer.Option(min=0, help="Of all random numbers.")]
