"""Compressed bytes to bytes, never more than was said: zstd and lz4, from the extra `bag`."""

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from elbowroom.errors import BagError
from elbowroom.extras import package

ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
LARGEST_WINDOW = 1 << 27
"""That a zstd stream may ask to be kept in memory [bytes]."""
PIECE = 1 << 18


def is_zstd(start: bytes | memoryview) -> bool:
    """Whether bytes begin as a zstd frame does."""
    return bytes(start[:4]) == ZSTD_MAGIC


def unpacked(data: bytes | memoryview, kind: str, most: int, what: str) -> bytes:
    """The bytes that were compressed.

    Args:
        data: compressed.
        kind: "zstd", "lz4", or "" for none.
        most: more than this is refused [bytes].
        what: names the data in errors.

    Raises:
        BagError: damaged, cut off, or more than `most`.
        PackageError: the package that reads it is not installed.
    """
    whole, damage = unpacked_as_far(data, kind, most, what)
    if damage is not None:
        raise BagError(f"{what}: damaged or cut off ({damage})")
    return whole


def unpacked_as_far(data: bytes | memoryview, kind: str, most: int, what: str) -> tuple[bytes, str | None]:
    """The bytes up to where they are damaged or end too early, and what is wrong there; None: nothing.

    Args:
        data, kind, most, what: as of `unpacked`.

    Raises:
        BagError: more than `most`.
        PackageError: the package that reads it is not installed.
    """
    if kind == "":
        return bytes(data), None
    pieces, size, damage = [], 0, None
    try:
        for piece in _pieces(io.BytesIO(data), kind, what):
            pieces.append(piece)
            size += len(piece)
            if size > most:
                raise BagError(f"{what}: unpacks to more than the {most:,} bytes that it may have")
    except _Damaged as error:
        damage = str(error)
    if damage is None and kind == "zstd" and size < _said(data):
        damage = f"{size:,} bytes of {_said(data):,}"
    return b"".join(pieces), damage


def _said(data: bytes | memoryview) -> int:
    """How many bytes a zstd frame says that it holds; 0 or less: it does not."""
    try:
        return int(package("zstandard").frame_content_size(bytes(data[:18])))
    except package("zstandard").ZstdError:
        return 0


def unpack_file(source: Path, into: Path, most: int) -> str | None:
    """Unpacks a file compressed with zstd, as far as it goes; what is wrong with it, or None.

    Args:
        source: the file.
        into: the file to write.
        most: more than this is refused [bytes].

    Raises:
        BagError: more than `most`, or the disk is full.
        PackageError: zstandard is not installed.
    """
    size = 0
    try:
        with source.open("rb") as packed, into.open("wb") as out:
            for piece in _pieces(packed, "zstd", str(source)):
                size += len(piece)
                if size > most:
                    raise BagError(
                        f"{source}: unpacks to more than {most:,} bytes, which are left on this disk"
                    )
                out.write(piece)
    except _Damaged as error:
        return str(error)
    except OSError as error:
        raise BagError(f"{source}: cannot be unpacked into {into.parent} ({error.strerror})") from None
    return None


class _Damaged(Exception):
    """Compressed data that ends too early or is none; its text says which."""


def _pieces(packed: BinaryIO, kind: str, what: str) -> Iterator[bytes]:
    if kind == "zstd":
        return _zstd_pieces(packed)
    if kind == "lz4":
        return _lz4_pieces(packed)
    raise BagError(f"{what}: compressed with {kind!r}; zstd and lz4 are read")


def _zstd_pieces(packed: BinaryIO) -> Iterator[bytes]:
    zstd = package("zstandard")
    reader = zstd.ZstdDecompressor(max_window_size=LARGEST_WINDOW).stream_reader(
        packed, read_across_frames=True
    )
    try:
        while piece := reader.read(PIECE):
            yield piece
    except (zstd.ZstdError, MemoryError) as error:
        raise _Damaged(str(error)) from None


def _lz4_pieces(packed: BinaryIO) -> Iterator[bytes]:
    lz4: Any = package("lz4.frame")
    reader, given = lz4.LZ4FrameDecompressor(), packed.read()
    try:
        while not reader.eof:
            piece = reader.decompress(given, max_length=PIECE)
            given = b""
            if piece:
                yield piece
            elif reader.needs_input:
                raise _Damaged("it ends too early")
    except RuntimeError as error:
        raise _Damaged(str(error)) from None
