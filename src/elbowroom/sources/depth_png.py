"""Depth images on disk: 16-bit grey PNG, checked before anything is decoded."""

import io
import struct
import warnings
from contextlib import nullcontext
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.errors import FrameError
from elbowroom.files.content import what_it_is
from elbowroom.files.damaged_picture import DAMAGED, chunk_beyond_end
from elbowroom.sources.depth_pgm import exchanged

HEADER = 26
"""So many bytes say what a PNG is."""
SIGNATURE = b"\x89PNG\r\n\x1a\n"
MAX_FILE_BYTES_PER_PIXEL = 4
"""A PNG of 16 bits is not larger than its pixels, give or take; text chunks beyond this are not read."""
COLOURS = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGB with alpha"}


def check_depth_png(path: Path, width: int, height: int) -> None:
    """Looks at a file's header, decodes nothing.

    Args:
        path: the file.
        width, height: size that its camera delivers [px].

    Raises:
        FrameError: missing, no PNG, another size, not 16 bits of grey, or a file far too large for its image.
    """
    if not path.is_file():
        raise FrameError(f"{path}: no such file; expected a 16-bit PNG of {width} x {height}")
    with path.open("rb") as file:
        header = file.read(HEADER)
    _require_header(str(path), header, path.stat().st_size, (width, height))


def _require_header(name: str, header: bytes, length: int, size: tuple[int, int]) -> None:
    """Looks at the first bytes of a PNG, and at how long it is; raises as `check_depth_png`."""
    width, height = size
    if len(header) < HEADER or header[:8] != SIGNATURE or header[12:16] != b"IHDR":
        found = what_it_is(header)
        raise FrameError(
            f"{name}: {found}; expected a 16-bit PNG or PGM"
            if found and not header.startswith(SIGNATURE)
            else f"{name}: not a PNG file, or cut off in its first bytes; expected a 16-bit PNG or PGM"
        )
    found_width, found_height, depth, colour = struct.unpack(">IIBB", header[16:26])
    if (found_width, found_height) != (width, height):
        raise FrameError(
            f"{name}: {found_width} x {found_height} pixels, its camera has {width} x {height}"
            f"{exchanged((found_width, found_height), (width, height))}"
        )
    if (depth, colour) != (16, 0):
        raise FrameError(f"{name}: {depth} bits of {COLOURS.get(colour, 'unknown')}, must be 16 bits of grey")
    allowed = MAX_FILE_BYTES_PER_PIXEL * width * height + 1_000_000
    if length > allowed:
        raise FrameError(f"{name}: {length:,} bytes, at most {allowed:,} for {width} x {height}")


def read_depth_png(path: Path, width: int, height: int) -> NDArray[np.uint16]:
    """The sensor's whole numbers.

    Args:
        path: the file.
        width, height: size that its camera delivers [px].

    Returns:
        shape (height, width), uint16.

    Raises:
        FrameError: as `check_depth_png`, or the file is truncated or damaged.
    """
    check_depth_png(path, width, height)
    return _decoded(path, str(path), (width, height))


def check_png_bytes(data: bytes, name: str, width: int, height: int) -> None:
    """Looks at the header of a PNG that is no file of its own, decodes nothing.

    Args:
        data: the PNG, whole.
        name: what it is called in errors.
        width, height: size that its camera delivers [px].

    Raises:
        FrameError: as `check_depth_png`.
    """
    _require_header(name, data[:HEADER], len(data), (width, height))


def png_pixels(data: bytes, name: str, width: int, height: int) -> NDArray[np.uint16]:
    """The sensor's whole numbers of a PNG that is no file of its own, shape (height, width), uint16.

    Args:
        data, name, width, height: as of `check_png_bytes`.

    Raises:
        FrameError: as `read_depth_png`.
    """
    check_png_bytes(data, name, width, height)
    return _decoded(io.BytesIO(data), name, (width, height))


def _decoded(source: Path | io.BytesIO, name: str, size: tuple[int, int]) -> NDArray[np.uint16]:
    """The pixels of a PNG whose header was looked at; raises as `read_depth_png`."""
    width, height = size
    with source.open("rb") if isinstance(source, Path) else nullcontext(source) as opened:
        if chunk_beyond_end(opened):
            raise FrameError(
                f"{name}: truncated or damaged PNG (a chunk ends beyond the file); record or copy it again"
            )
    try:
        with warnings.catch_warnings():
            # a size that a camera has was checked before and is no decompression bomb
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(source, formats=("PNG",)) as image:
                # checks every chunk's sum, which decoding alone does not
                image.verify()
            if isinstance(source, io.BytesIO):
                source.seek(0)
            with Image.open(source, formats=("PNG",)) as image:
                pixels = np.asarray(image)
    except DAMAGED as error:
        raise FrameError(f"{name}: truncated or damaged PNG ({error}); record or copy it again") from None
    if pixels.shape != (height, width) or pixels.dtype.kind not in "iu":
        raise FrameError(f"{name}: decoded to {pixels.dtype} {pixels.shape}, must be 16 bits of grey")
    return pixels.astype(np.uint16)
