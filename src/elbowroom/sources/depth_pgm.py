"""Depth images on disk: 16-bit binary PGM as netpbm describes it, the more significant byte first."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError

LONGEST_HEADER = 4096
"""Comments and all [bytes]."""
MOST_8_BIT, MOST_16_BIT = 255, 65535
_HEADER = re.compile(rb"(P[1-6])(?:(?:\s*#[^\n\r]*[\n\r])|\s)+", re.ASCII)
_NUMBER = re.compile(rb"(?:(?:#[^\n\r]*[\n\r])|\s)*([0-9]{1,9})", re.ASCII)
KINDS = {
    b"P1": "a bitmap", b"P2": "a PGM in text", b"P3": "a colour PPM in text", b"P4": "a bitmap", b"P6": "a colour PPM",
}  # fmt: skip


def is_pgm(start: bytes) -> bool:
    """Whether a file that begins so is one of netpbm's."""
    return len(start) >= 2 and start[:1] == b"P" and start[1:2] in b"123456"


def check_depth_pgm(path: Path, width: int, height: int) -> int:
    """Looks at a file's header and its length.

    Args:
        path: the file, which is there.
        width, height: size that its camera delivers [px].

    Returns:
        Where the pixels begin [bytes].

    Raises:
        FrameError: no binary PGM of 16 bits, another size, or fewer or more pixels than its header says.
    """
    if not path.is_file():
        raise FrameError(f"{path}: is no file")
    with path.open("rb") as file:
        start = file.read(LONGEST_HEADER)
    kind = _HEADER.match(start)
    if kind is None:
        raise FrameError(f"{path}: not a PGM file, or cut off in its first bytes; expected a 16-bit PGM (P5)")
    if kind[1] != b"P5":
        raise FrameError(
            f"{path}: {kind[1].decode()}, {KINDS[kind[1]]}; must be a binary PGM (P5) of 16 bits"
        )
    numbers, at = [], kind.end()
    for _ in range(3):
        found = _NUMBER.match(start, at)
        if found is None:
            raise FrameError(f"{path}: a PGM whose header has no width, height and greatest value")
        numbers.append(int(found[1]))
        at = found.end()
    return _fits(path, numbers, at + 1, (width, height))


def _fits(path: Path, numbers: list[int], begin: int, size: tuple[int, int]) -> int:
    """Where the pixels begin; raises as `check_depth_pgm`."""
    width, height, greatest = numbers
    if (width, height) != size:
        raise FrameError(
            f"{path}: {width} x {height} pixels, its camera has {size[0]} x {size[1]}{exchanged((width, height), size)}"
        )
    if not MOST_8_BIT < greatest <= MOST_16_BIT:
        bits = "8 bits" if 0 < greatest <= MOST_8_BIT else f"a greatest value of {greatest}"
        raise FrameError(f"{path}: {bits} of grey, must be 16 bits: a greatest value of 256 to 65535")
    wanted, there = 2 * width * height, path.stat().st_size - begin
    if there < wanted:
        raise FrameError(
            f"{path}: truncated PGM, {there:,} bytes of pixels of {wanted:,}; record or copy it again"
        )
    if there > wanted + 1:
        raise FrameError(f"{path}: {there:,} bytes of pixels, must be {wanted:,}: one image a file")
    return begin


def read_depth_pgm(path: Path, width: int, height: int) -> NDArray[np.uint16]:
    """The sensor's whole numbers, shape (height, width), uint16.

    Args:
        path: the file, which is there.
        width, height: size that its camera delivers [px].

    Raises:
        FrameError: as `check_depth_pgm`.
    """
    begin = check_depth_pgm(path, width, height)
    with path.open("rb") as file:
        file.seek(begin)
        pixels = np.frombuffer(file.read(2 * width * height), dtype=">u2")
    return pixels.reshape(height, width).astype(np.uint16)


def exchanged(found: tuple[int, int], size: tuple[int, int]) -> str:
    """A hint where width and height are those of the camera, the other way round.

    Args:
        found: width and height of the image [px].
        size: of the camera [px].
    """
    return "; width and height look exchanged" if found == (size[1], size[0]) and size[0] != size[1] else ""
