"""Depth images as ROS sends them (REP 118): 16UC1 in whole numbers, 32FC1 in metres, or either as compressedDepth."""

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError
from elbowroom.sources.bags.messages import IMAGE, RawImage, compressed_of, image_of
from elbowroom.sources.bags.rvl import rvl_pixels
from elbowroom.sources.depth_pgm import exchanged
from elbowroom.sources.depth_png import check_png_bytes, png_pixels
from elbowroom.wire import depth_codec
from elbowroom.wire.ros_messages import PLANAR, RADIAL

Pixels = NDArray[np.uint16] | NDArray[np.float32]
WHOLE, METRES = "16UC1", "32FC1"
ENCODINGS = {WHOLE: 2, "mono16": 2, METRES: 4}
"""Encodings that are read, and their bytes a pixel."""
OWN, OWN_RADIAL = "elbowroom", "elbowroom, radial"
"""Packing of a recorded run: metres, not quantised; or such from the camera's centre."""
TRANSPORT = "compressedDepth"
CONFIG = struct.Struct("<iff")
"""Of that transport: a number, and A and B of what stands in a pixel for a depth z [m]: floor(A / z + B)."""
RVL_SIZE = struct.Struct("<II")
LARGEST_SIDE = 20_000


class Kind(NamedTuple):
    """What a depth image is, without its pixels.

    Args:
        frame: in whose axes it is.
        stamp_ns: of its header [ns].
        encoding: "16UC1" or "32FC1".
        size: width and height [px].
        packing: "", "png", "rvl", or `OWN` or `OWN_RADIAL` of a recorded run (`wire/depth_codec.py`).
    """

    frame: str
    stamp_ns: int
    encoding: str
    size: tuple[int, int]
    packing: str

    @property
    def text(self) -> str:
        """In a few words: "16UC1 as png, 640x480"."""
        packed = f" as {self.packing}" if self.packing else ""
        return f"{self.encoding}{packed}, {self.size[0]}x{self.size[1]}"


class _Packed(NamedTuple):
    kind: Kind
    a: float
    b: float
    data: memoryview


def kind_of(type_: str, data: bytes, what: str) -> Kind:
    """What a message is.

    Args:
        type_: of the topic: sensor_msgs/msg/Image or CompressedImage.
        data: the message.
        what: names it in errors.

    Raises:
        BagError: malformed.
        FrameError: no depth image, or one whose data is not what its size says.
    """
    if type_ == IMAGE:
        image = image_of(data, what)
        _require_fit(image, what)
        encoding = METRES if image.encoding == METRES else WHOLE
        return Kind(image.header.frame, image.header.stamp_ns, encoding, (image.width, image.height), "")
    return _packed(data, what).kind


def check_depth(type_: str, data: bytes, what: str, size: tuple[int, int]) -> None:
    """Makes sure that a message can be what its camera delivers, without decoding it.

    Args:
        type_, data, what: as of `kind_of`.
        size: width and height of its camera's images [px].

    Raises:
        BagError, FrameError: as `kind_of`, or another size.
    """
    found = kind_of(type_, data, what).size
    if found != size:
        raise FrameError(
            f"{what}: {found[0]} x {found[1]} pixels, its camera has {size[0]} x {size[1]}{exchanged(found, size)}"
        )


def depth_of(type_: str, data: bytes, what: str, size: tuple[int, int]) -> Pixels:
    """The pixels of a message: whole numbers as uint16, or metres as float32; shape (height, width).

    Metres that were quantised are read as the nearest depth that gives the number: never farther than was measured.

    Args:
        type_, data, what, size: as of `check_depth`.

    Raises:
        BagError, FrameError: as `check_depth`, or pixels that are damaged.
    """
    check_depth(type_, data, what, size)
    if type_ == IMAGE:
        return _raw_pixels(image_of(data, what))
    packed = _packed(data, what)
    width, height = size
    if packed.kind.packing in (OWN, OWN_RADIAL):
        return depth_codec.unpack_depth(packed.data, what)
    if packed.kind.packing == "rvl":
        numbers = rvl_pixels(packed.data, what, width, height)
    else:
        numbers = png_pixels(bytes(packed.data), what, width, height)
    return numbers if packed.kind.encoding == WHOLE else metres_of(numbers, packed.a, packed.b)


def metres_of(numbers: NDArray[np.uint16], a: float, b: float) -> NDArray[np.float32]:
    """Depth [m] of floor(a / z + b): the nearest z that gives the number; 0 where there is none.

    Args:
        numbers: shape (height, width).
        a, b: of the message.
    """
    under = numbers.astype(np.float64) + 1.0 - b
    there = (numbers > 0) & (under > 0)
    metres = np.where(there, a / np.where(there, under, 1.0), 0.0).astype(np.float32)
    # rounding to 32 bits may not lead away from the camera either
    return np.where(there, np.nextafter(metres, np.float32(0)), np.float32(0))


def quantum(type_: str, data: bytes, what: str) -> float | None:
    """How much farther than read a depth z may be, over z squared [1/m]; None: this image was not quantised.

    Args:
        type_, data, what: as of `kind_of`.
    """
    if type_ == IMAGE:
        return None
    packed = _packed(data, what)
    is_quantised = packed.kind.encoding == METRES and packed.kind.packing not in (OWN, OWN_RADIAL)
    return 1.0 / packed.a if is_quantised else None


def _raw_pixels(image: RawImage) -> Pixels:
    order = ">" if image.big_endian else "<"
    kind = "f4" if image.encoding == METRES else "u2"
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    own = rows[:, : image.width * ENCODINGS[image.encoding]]
    read = np.ascontiguousarray(own).view(f"{order}{kind}")
    return read.astype(np.float32) if kind == "f4" else read.astype(np.uint16)


def _require_fit(image: RawImage, what: str) -> None:
    each = ENCODINGS.get(image.encoding)
    if each is None:
        raise FrameError(f"{what}: encoding {image.encoding!r} is no depth; 16UC1 and 32FC1 are read")
    _require_size((image.width, image.height), what)
    if image.step < image.width * each:
        raise FrameError(
            f"{what}: rows of {image.step:,} bytes, {image.width} pixels take {image.width * each:,}"
        )
    if len(image.data) != image.height * image.step:
        raise FrameError(
            f"{what}: {len(image.data):,} bytes of pixels, {image.height} rows of {image.step:,} are "
            f"{image.height * image.step:,}"
        )


def _require_size(size: tuple[int, int], what: str) -> None:
    if not all(0 < side <= LARGEST_SIDE for side in size):
        raise FrameError(f"{what}: an image of {size[0]:,} x {size[1]:,} pixels")


def _packed(data: bytes, what: str) -> _Packed:
    """A message of the transport compressedDepth: twelve bytes, then a PNG, or width, height and RVL; or of a run."""
    image = compressed_of(data, what)
    if image.format in (PLANAR, RADIAL):
        size = depth_codec.head_of(image.data, what).size
        _require_size(size, what)
        packing = OWN if image.format == PLANAR else OWN_RADIAL
        own = Kind(image.header.frame, image.header.stamp_ns, METRES, size, packing)
        return _Packed(own, 1.0, 0.0, image.data)
    encoding, _, transport = (part.strip() for part in image.format.partition(";"))
    if not transport.startswith(TRANSPORT):
        raise FrameError(
            f"{what}: format {image.format!r} is no depth; that of the transport compressedDepth is read"
        )
    if encoding not in ENCODINGS:
        raise FrameError(f"{what}: encoding {encoding!r} is no depth; 16UC1 and 32FC1 are read")
    packing = transport.removeprefix(TRANSPORT).strip() or "png"
    if packing not in ("png", "rvl"):
        raise FrameError(f"{what}: compressedDepth as {packing!r}; png and rvl are read")
    if len(image.data) < CONFIG.size + 26:
        raise FrameError(f"{what}: {len(image.data)} bytes of compressedDepth, which is cut off")
    _, a, b = CONFIG.unpack_from(image.data)
    if encoding == METRES and not (np.isfinite([a, b]).all() and a > 0):
        raise FrameError(f"{what}: depth is quantised by A = {a:g} and B = {b:g}; A must be above 0")
    rest, size = _sized(image.data[CONFIG.size :], packing, what)
    kind = METRES if encoding == METRES else WHOLE
    return _Packed(Kind(image.header.frame, image.header.stamp_ns, kind, size, packing), a, b, rest)


def _sized(rest: memoryview, packing: str, what: str) -> tuple[memoryview, tuple[int, int]]:
    """The packed pixels and their size, by their own header."""
    if packing == "rvl":
        size = RVL_SIZE.unpack_from(rest)
        rest = rest[RVL_SIZE.size :]
    else:
        size = struct.unpack(">II", rest[16:24])
    _require_size(size, what)
    if packing == "png":
        check_png_bytes(bytes(rest), what, *size)
    return rest, size
