"""Depth images on disk, of whichever format: 16 bits of grey, as PNG or PGM."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.sources.depth_pgm import check_depth_pgm, is_pgm, read_depth_pgm
from elbowroom.sources.depth_png import check_depth_png, read_depth_png

KINDS = (".png", ".pgm")
"""Endings of the names of depth images."""


def images_in(folder: Path) -> list[Path]:
    """The files of a folder whose names end as those of depth images, in the order of their names."""
    return sorted(path for kind in KINDS for path in folder.glob(f"*{kind}"))


def check_depth_image(path: Path, width: int, height: int) -> None:
    """Looks at a file's header, decodes nothing.

    Args:
        path: the file.
        width, height: size that its camera delivers [px].

    Raises:
        FrameError: missing, neither PNG nor PGM, another size, or not 16 bits of grey.
    """
    if _is_pgm(path):
        check_depth_pgm(path, width, height)
    else:
        check_depth_png(path, width, height)


def read_depth_image(path: Path, width: int, height: int) -> NDArray[np.uint16]:
    """The sensor's whole numbers, shape (height, width), uint16.

    Args:
        path: the file.
        width, height: size that its camera delivers [px].

    Raises:
        FrameError: as `check_depth_image`, or the file is truncated or damaged.
    """
    read = read_depth_pgm if _is_pgm(path) else read_depth_png
    return read(path, width, height)


def _is_pgm(path: Path) -> bool:
    """By its first bytes, whatever its name is."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return is_pgm(file.read(2))
