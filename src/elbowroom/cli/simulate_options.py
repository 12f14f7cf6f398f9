"""Options that both kinds of simulated recording share."""

from typing import Annotated, Literal

import typer

Size = Literal["vga", "qqvga", "thesis"]
ImageSize = Annotated[Size, typer.Option(help="Of their images.")]
Noise = Annotated[str, typer.Option(help="exact, or a sensor such as tof, kinect_v1.")]
