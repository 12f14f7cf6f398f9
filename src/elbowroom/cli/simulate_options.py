"""Options that both kinds of simulated recording share."""

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
