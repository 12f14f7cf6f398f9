"""Masks of cameras on disk: PNG of the camera's size, black where pixels say nothing, white where they count."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.errors import SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.files.damaged_picture import DAMAGED, chunk_beyond_end


def read_mask(path: Path, width: int, height: int) -> NDArray[np.bool_]:
    """The pixels that say nothing.

    Args:
        path: the file: 8 bits of grey, or black and white; nothing but black (0) and white (255).
        width, height: size that its camera delivers [px].

    Returns:
        shape (height, width), true where the file is black.

    Raises:
        SiteError: missing, no PNG, another size, values that are neither black nor white, or all black.
    """
    if not path.is_file():
        raise SiteError(f"mask: no file {path}; elbowroom site mask makes one, white where pixels count")
    with path.open("rb") as opened:
        if chunk_beyond_end(opened):
            raise SiteError(f"mask: {path}: not a PNG file, or damaged (a chunk ends beyond the file)")
    try:
        with Image.open(path, formats=("PNG",)) as image:
            size, mode = image.size, image.mode
            if size != (width, height):
                raise SiteError(
                    f"mask: {path} is {size[0]} x {size[1]} pixels, its camera has {width} x {height}"
                )
            if mode not in ("1", "L"):
                raise SiteError(f"mask: {path} is a picture of mode {mode}, must be 8 bits of grey")
            grey = np.asarray(image.convert("L"))
    except DAMAGED as error:
        raise SiteError(f"mask: {path}: not a PNG file, or damaged ({error})") from None
    if not np.isin(grey, (0, 255)).all():
        raise SiteError(f"mask: {path} has grey values; must be black (says nothing) or white (counts)")
    masked = grey == 0
    if masked.all():
        raise SiteError(f"mask: {path} is black all over, its camera would say nothing; white is what counts")
    return np.asarray(masked)


def write_mask(path: Path, mask: NDArray[np.bool_]) -> Path:
    """Writes a mask that `read_mask` reads.

    Args:
        path: the file.
        mask: true where pixels say nothing, shape (height, width).

    Raises:
        InputError: the folder does not exist or cannot be written to.
    """
    with whole_file(path) as unfinished:
        Image.fromarray(np.where(mask, 0, 255).astype(np.uint8)).save(unfinished, format="PNG")
    return path
