"""Depth images on disk, of whichever format: 16 bits of grey, as PNG or PGM."""

from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.sources.depth_pgm import check_depth_pgm, is_pgm, read_depth_pgm
from elbowroom.sources.depth_png import check_depth_png, read_depth_png

KINDS = (".png", ".pgm")
"""Endings of the names of depth images."""
OF_A_RECORDING = (*KINDS, ".csv", ".json", ".yaml", ".yml", ".txt", ".md")
"""Endings of what may lie there, too."""


def images_in(folder: Path) -> list[Path]:
    """The files of a folder whose names end as those of depth images, in the order of their names; no hidden ones."""
    return sorted(path for path in folder.glob("*") if path.suffix.lower() in KINDS and not is_hidden(path))


def is_hidden(path: Path) -> bool:
    """Whether a file or folder is none of the user's: systems and viewers write `._name`, `.thumbnails`, `@eaDir`."""
    return path.name.startswith((".", "@"))


def others_text(folder: Path) -> str:
    """What is there instead of depth images, as the end of a sentence; "": nothing.

    Args:
        folder: of a recording, with a folder for each camera.
    """
    files = [path for path in folder.glob("*/*") if path.is_file() and not is_hidden(path)]
    files += [path for path in folder.glob("*") if path.is_file() and not is_hidden(path)]
    endings = Counter(path.suffix.lower() for path in files if path.suffix.lower() not in OF_A_RECORDING)
    if not endings:
        return ""
    ending, count = endings.most_common(1)[0]
    kind = f"files {ending}" if ending else "files without an ending"
    return f"; there are {count} {kind}: write depth as 16-bit PNG"


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
