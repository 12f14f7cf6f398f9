"""A depth image packed without loss: what is unpacked has the same bits.

    4 bytes  "EBD1", or "EBD2" of kind 3
    1        0: units, one code a byte; 1: units, two codes a byte; 2: the bits of float32; 3: units in rows of eight
    4 and 4  width, height [px]
    4        how many numbers follow apart (0 in kinds 2 and 3)
    4 and 4  metres per unit, and what is added after that [m], float32 (0 in kind 2)
    rest     zstd: codes; then of the numbers apart all low bytes, then all high ones. In kind 2: the lowest bytes of
             all pixels' zigzags of differences, then the next ones, four times. In kind 3 no zstd: how many bits the
             numbers of each row take, half a byte each, to whole bytes; then words of 16 bits, eight abreast

Numbers are little-endian; what codes are is said in `kernels/depth.py`, what rows are in `kernels/rows.py`. An image of
whose steps most are small is packed as codes, since zstd finds how rarely the others come; any other as rows, which
are a tenth larger than codes and zstd, and take half as long. Units are what a sensor counted: depth is their product
with the scale, in float32, plus the bias. An image that is not made of units is packed as its bits, so NaN, infinity
and minus zero come back as they were.
"""

import struct
import threading
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError
from elbowroom.extras import package
from elbowroom.wire.kernels import depth as kernels
from elbowroom.wire.kernels import rows as row_kernels
from elbowroom.wire.kernels.rows import ROW

MAGIC, MAGIC_OF_ROWS = b"EBD1", b"EBD2"
HEAD = struct.Struct("<4sBIIIff")
BYTES, HALVES, FLOATS, ROWS = range(4)
MOST_PIXELS = 1 << 26
"""No image that is read here has more pixels."""
HALVES_BELOW = 0.25
"""Two codes share a byte where less than this share of an image would follow apart."""
QUIET, QUIET_BELOW = 8, 0.25
"""An image is packed as codes where less than this share of its zigzags is `QUIET` or above."""
PARAMETERS: dict[str, int] = {"hash_log": 10, "min_match": 7}
"""Of zstd at level 1: a smaller table is as good for such codes, and stays in the nearest cache."""

_own = threading.local()


class Units(NamedTuple):
    """What a camera's whole numbers stand for.

    Args:
        scale_m: metres per unit.
        bias_m: what is added after that [m].
    """

    scale_m: float
    bias_m: float = 0.0


class Packed(NamedTuple):
    """What a packed image says of itself.

    Args:
        size: width and height [px].
        units: None: it holds floats.
        kind, apart: as the head says.
    """

    size: tuple[int, int]
    units: Units | None
    kind: int
    apart: int

    @property
    def content(self) -> int:
        """How many bytes there are before zstd, if there is any."""
        pixels = self.size[0] * self.size[1]
        if self.kind == FLOATS:
            return 4 * pixels
        return (pixels if self.kind == BYTES else (pixels + 1) // 2) + 2 * self.apart


def pack_depth(depth_m: NDArray[np.float32], units: Units | None) -> bytes:
    """An image, packed.

    Args:
        depth_m: float32, shape (height, width) [m], contiguous.
        units: of which it may be made; if it is not, its bits are packed.

    Raises:
        PackageError: zstandard is not installed.
    """
    return b"".join(packed_pieces(depth_m, units))


def packed_pieces(depth_m: NDArray[np.float32], units: Units | None) -> list[bytes | memoryview]:
    """An image, packed, in pieces that stand until this thread packs the next one.

    Args:
        depth_m, units: as of `pack_depth`.

    Raises:
        PackageError: zstandard is not installed.
    """
    height, width = depth_m.shape
    flat = depth_m.reshape(-1)
    found = None if units is None else _in_units(flat, units)
    if found is None or units is None:
        head = HEAD.pack(MAGIC, FLOATS, width, height, 0, 0.0, 0.0)
        return [head, _compressed(_float_bytes(flat))]
    kind, many, content = found
    magic = MAGIC_OF_ROWS if kind == ROWS else MAGIC
    return [HEAD.pack(magic, kind, width, height, many, units.scale_m, units.bias_m), *content]


def head_of(data: bytes | memoryview, what: str) -> Packed:
    """What a packed image says of itself, nothing unpacked.

    Args:
        data: as `pack_depth` gave it.
        what: names it in errors.

    Raises:
        BagError: it is none, or says what cannot be.
    """
    if len(data) < HEAD.size or bytes(data[:4]) not in (MAGIC, MAGIC_OF_ROWS):
        raise BagError(f"{what}: {len(data):,} bytes that are no packed depth image")
    magic, kind, width, height, apart, scale, bias = HEAD.unpack_from(data)
    pixels = width * height
    sound = kind == ROWS and apart == 0 if magic == MAGIC_OF_ROWS else kind <= FLOATS
    sound = sound and 0 < pixels <= MOST_PIXELS and apart <= pixels
    units = None
    if kind != FLOATS:
        sound = sound and bool(np.isfinite([scale, bias]).all()) and scale > 0
        units = Units(scale, bias)
    if not sound:
        raise BagError(f"{what}: a packed depth image whose head is damaged")
    return Packed((width, height), units, kind, apart)


def unpack_depth(data: bytes | memoryview, what: str) -> NDArray[np.float32]:
    """The image, shape (height, width), float32 [m], read-only.

    Args:
        data: as `pack_depth` gave it.
        what: names it in errors.

    Raises:
        BagError: damaged; nothing larger is made than the image that it says.
        PackageError: zstandard is not installed.
    """
    head = head_of(data, what)
    # what there is of it is unpacked first: a head alone makes nothing large
    if head.units is None:
        zigzag = _unpacked(data, head, what).reshape(4, -1).T.copy().view("<u4").reshape(-1)
        image = np.empty(head.size[::-1], np.float32)
        kernels.from_differences_32(zigzag, image.reshape(-1).view(np.uint32))
    else:
        numbers = _numbers(data, head, what)
        image = np.empty(head.size[::-1], np.float32)
        scale, bias = np.float32(head.units.scale_m), np.float32(head.units.bias_m)
        kernels.from_units(numbers, scale, bias, image.reshape(-1))
    image.setflags(write=False)
    return image


def unpack_units(data: bytes | memoryview, what: str) -> NDArray[np.uint16] | None:
    """The image in whole units, shape (height, width); None: it is not made of units.

    Args:
        data: as `pack_depth` gave it.
        what: names it in errors.

    Raises:
        BagError, PackageError: as `unpack_depth`.
    """
    head = head_of(data, what)
    return None if head.units is None else _numbers(data, head, what).reshape(head.size[::-1])


def warm_up() -> None:
    """Compiles what packs images.

    Raises:
        PackageError: zstandard is not installed.
    """
    for image in (
        np.zeros((1, 1), np.float32),
        np.full((1, 1), 0.0301, np.float32),
        np.full((8, 8), 30, np.float32),
    ):
        image.setflags(write=False)
        for units in (Units(0.001), None):
            pack_depth(image, units)


def _in_units(flat: NDArray[np.float32], units: Units) -> tuple[int, int, list[bytes | memoryview]] | None:
    """Kind, how many numbers follow apart, and what follows the head; None: the image is not made of units."""
    scale, bias = np.float32(units.scale_m), np.float32(units.bias_m)
    if not (np.isfinite(scale) and scale > 0 and np.isfinite(bias)):
        return None
    if kernels.steps_above(flat, scale, QUIET) < QUIET_BELOW * flat.size / kernels.SAMPLED:
        found = _in_codes(flat, scale, bias)
        return None if found is None else (*found[:2], [_compressed(found[2])])
    content, words = _scratch(flat.size)
    widths = content[: _widths(flat.size)]
    used = row_kernels.pack_rows(flat, flat.view(np.int32), scale, bias, widths, words)
    return None if used < 0 else (ROWS, 0, [widths.data, _bytes_of(words[: ROW * used])])


def _bytes_of(words: NDArray[np.uint16]) -> memoryview:
    return words.astype("<u2", copy=False).view(np.uint8).data


def _widths(pixels: int) -> int:
    """How many bytes say what rows take."""
    return -(-pixels // (2 * ROW))


def _in_codes(
    flat: NDArray[np.float32], scale: np.float32, bias: np.float32
) -> tuple[int, int, NDArray[np.uint8]] | None:
    """Kind, how many numbers follow apart, and what is compressed; None: the image is not made of units."""
    is_half = bool(
        kernels.steps_above(flat, scale, kernels.HALF) < HALVES_BELOW * flat.size / kernels.SAMPLED
    )
    content, apart = _scratch(flat.size)
    length = (flat.size + 1) // 2 if is_half else flat.size
    many = kernels.pack_units(flat, flat.view(np.int32), scale, bias, is_half, content[:length], apart)
    if many < 0:
        return None
    content[length : length + many] = apart[:many]  # the low bytes of them
    content[length + many : length + 2 * many] = apart[:many] >> 8
    return HALVES if is_half else BYTES, many, content[: length + 2 * many]


def _scratch(pixels: int) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Memory of this thread's own: for codes or widths, and for numbers that follow apart or words."""
    kept: tuple[NDArray[np.uint8], NDArray[np.uint16]] | None = getattr(_own, "scratch", None)
    if kept is None or len(kept[1]) != pixels + 3 * ROW:
        kept = _own.scratch = np.empty(3 * pixels, np.uint8), np.empty(pixels + 3 * ROW, np.uint16)
    return kept


def _float_bytes(flat: NDArray[np.float32]) -> NDArray[np.uint8]:
    zigzag = np.empty(flat.size, np.uint32)
    kernels.differences_32(flat.view(np.uint32), zigzag)
    return _planes(zigzag)


def _planes(numbers: NDArray[Any]) -> NDArray[np.uint8]:
    """The lowest bytes of all, then the next ones."""
    little = numbers.astype(numbers.dtype.newbyteorder("<"), copy=False)
    return np.ascontiguousarray(little.view(np.uint8).reshape(-1, numbers.itemsize).T).reshape(-1)


def _numbers(data: bytes | memoryview, head: Packed, what: str) -> NDArray[np.uint16]:
    """Whole units, shape (n,)."""
    if head.kind == ROWS:
        return _numbers_of_rows(memoryview(data)[HEAD.size :], head, what)
    content = _unpacked(data, head, what)
    codes = content[: len(content) - 2 * head.apart]
    apart = content[len(codes) :].reshape(2, -1).T.copy().view("<u2").reshape(-1)
    numbers = np.empty(head.size[0] * head.size[1], np.uint16)
    if not kernels.from_codes(codes, head.kind == HALVES, apart, numbers):
        raise BagError(f"{what}: a packed depth image that is damaged")
    return numbers


def _numbers_of_rows(body: memoryview, head: Packed, what: str) -> NDArray[np.uint16]:
    pixels = head.size[0] * head.size[1]
    length = len(body) - _widths(pixels)
    if length < 0 or length % (2 * ROW):
        raise BagError(f"{what}: a packed depth image that is damaged")
    widths = np.frombuffer(body, np.uint8, _widths(pixels))
    words = np.frombuffer(body[len(widths) :], np.uint8).copy().view("<u2")
    numbers = np.empty(pixels, np.uint16)
    if not row_kernels.from_rows(widths, words, numbers):
        raise BagError(f"{what}: a packed depth image that is damaged")
    return numbers


def _unpacked(data: bytes | memoryview, head: Packed, what: str) -> NDArray[np.uint8]:
    zstd = package("zstandard")
    body = memoryview(data)[HEAD.size :]
    try:
        # what a frame says of its size is asked before anything is made of that size
        if zstd.frame_content_size(body) != head.content:
            raise BagError(f"{what}: a packed depth image of another size than its head says")
        content = _tool("unpacks", lambda: zstd.ZstdDecompressor()).decompress(body)
    except zstd.ZstdError as error:
        raise BagError(f"{what}: a packed depth image that is damaged ({error})") from None
    if len(content) != head.content:
        raise BagError(f"{what}: a packed depth image that is damaged")
    return np.frombuffer(content, np.uint8)


def _compressed(content: NDArray[np.uint8]) -> bytes:
    zstd = package("zstandard")

    def made() -> Any:
        given = zstd.ZstdCompressionParameters.from_level(1, **PARAMETERS)
        return zstd.ZstdCompressor(compression_params=given)

    return bytes(_tool("packs", made).compress(content.data))


def _tool(name: str, made: Any) -> Any:
    """A compressor of this thread's own: one is not for several threads."""
    tool = getattr(_own, name, None)
    if tool is None:
        tool = made()
        setattr(_own, name, tool)
    return tool
