"""Draws each setup in colour, and what one of its cameras measures: python docs/images/setups.py"""

import sys
from pathlib import Path

from PIL import Image

from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.simulate import SETUPS, render, wall_cameras
from elbowroom.simulate import setup as setup_of
from elbowroom.view.draw.colour import View, colour_picture
from elbowroom.view.draw.depth import depth_picture

HERE = Path(__file__).resolve().parent
VIEW = View((4.2, -4.4, 4.0), (0.0, -0.05, 0.95), 44, 640, 480)
HIDDEN = ("ceiling", "wall +x", "wall -y")
CAMERA = 17
"""Of 21: hangs near the corner from where the colour picture is taken."""


def main() -> None:
    """Two pictures a setup."""
    machine = ceiling_c_arm()
    cameras = wall_cameras(21, (2.4, 0.4), height=480)
    for setup in SETUPS if len(sys.argv) == 1 else [setup_of(name) for name in sys.argv[1:]]:
        moment = setup.at(machine)
        shown = [solid for solid in moment.solids if solid.name not in HIDDEN]
        colour = colour_picture(shown, VIEW)
        colour.save(HERE / f"{setup.name}_colour.jpg", quality=86, optimize=True)
        (frame,) = render([cameras[CAMERA]], moment)
        depth = depth_picture(frame.depth_m).resize((480, 360), Image.Resampling.BILINEAR)
        depth.save(HERE / f"{setup.name}_depth.jpg", quality=86, optimize=True)


if __name__ == "__main__":
    main()
