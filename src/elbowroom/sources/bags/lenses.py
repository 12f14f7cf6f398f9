"""What a CameraInfo says of a lens, as the site file says it: the image's own pixels, in OpenCV's model."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError, CameraError
from elbowroom.geometry import Intrinsics
from elbowroom.sources.bags.messages import CameraInfo
from elbowroom.sources.depth_pgm import exchanged

PLUMB_BOB, RATIONAL, NO_MODEL = "plumb_bob", "rational_polynomial", ""
MODELS = {NO_MODEL: 0, "none": 0, "pinhole": 0, PLUMB_BOB: 5, RATIONAL: 8}
"""Models that are read, and how many coefficients of them."""
TURNED_DEG, BESIDE_M = 0.2, 0.001
"""What rectifying turns or moves by more is said [deg], [m]."""
RECTIFIED = "image_rect"
"""A topic whose last word begins so has images without distortion, whatever D says (REP 118, image_proc)."""


class Lens(NamedTuple):
    """What is said of a camera's lens.

    Args:
        intrinsics: of the image as it is sent.
        notes: what a reader should know.
    """

    intrinsics: Intrinsics
    notes: tuple[str, ...]


def lens_of(info: CameraInfo, size: tuple[int, int], rectified: bool, what: str) -> Lens:
    """The lens of an image.

    The matrix is of the whole sensor; the image may be a region of it, and binned. Pixel centres lie at whole numbers,
    and a binned pixel's in the middle of those that it is made of.

    Args:
        info: of the camera.
        size: width and height of the image [px].
        rectified: whether the image was made pinhole: then P says how, and D is past.
        what: names the topic in errors.

    Raises:
        BagError: a matrix that is none, another size, or a model that is not read.
    """
    is_plain = rectified and not info.p.any() and not info.d.any() and _is_same_axes(info.r)
    matrix = info.p[:, :3] if rectified and not is_plain else info.k
    if not np.isfinite(matrix).all() or matrix[0, 0] <= 0 or matrix[1, 1] <= 0:
        raise BagError(
            f"{what}: {'P' if rectified and not is_plain else 'K'} is {matrix.tolist()}; is this camera calibrated?"
        )
    binning, (x, y, width, height) = _binning(info), _region(info)
    _require_size(size, (width // binning[0], height // binning[1]), what)
    k = np.array(matrix) / matrix[2, 2] if matrix[2, 2] else np.array(matrix)
    notes = []
    if binning != (1, 1):
        notes.append(f"binned {binning[0]} x {binning[1]}: taken as pixels put together, not left out")
    try:
        plain = Intrinsics.from_matrix(k, () if rectified else _distortion(info, what))
    except CameraError as error:
        raise BagError(f"{what}: {error}") from None
    if rectified and np.any(info.d):
        notes.append("the images are rectified: P is taken, and D, which was before that, is not")
    if is_plain:
        notes.append("P is all zeros: K is taken, since D is 0, so that rectifying changes nothing")
    elif rectified:
        notes += _moved(info)
    own = Intrinsics(
        fx=plain.fx / binning[0],
        fy=plain.fy / binning[1],
        cx=(plain.cx - x + 0.5) / binning[0] - 0.5,
        cy=(plain.cy - y + 0.5) / binning[1] - 0.5,
        distortion=plain.distortion,
    )
    return Lens(own, tuple(notes))


def _is_same_axes(r: NDArray[np.float64]) -> bool:
    """Whether rectifying turns nothing: R is the identity, or was not filled in."""
    return not r.any() or bool(np.allclose(r, np.eye(3)))


def _moved(info: CameraInfo) -> list[str]:
    """What rectifying changed of where a camera is and how it looks, which the pose of its frame may not hold."""
    notes = []
    turn = float(np.degrees(np.arccos(np.clip((np.trace(info.r) - 1) / 2, -1, 1)))) if info.r.any() else 0.0
    if turn > TURNED_DEG:
        notes.append(
            f"rectified by R, a turn of {turn:.2g} degrees: is the pose of its frame that of the rectified axes?"
        )
    beside = -info.p[0, 3] / info.p[0, 0]
    if abs(beside) > BESIDE_M:
        notes.append(
            f"P says that it stands {1e3 * beside:.0f} mm to the right of its frame, as the second camera of a stereo "
            "pair does: is the pose of its frame that of the first?"
        )
    return notes


def _binning(info: CameraInfo) -> tuple[int, int]:
    """0 means 1."""
    return max(info.binning[0], 1), max(info.binning[1], 1)


def _region(info: CameraInfo) -> tuple[int, int, int, int]:
    """x, y, width and height of what is sent of the sensor; all 0 means all of it."""
    x, y, height, width = info.roi
    return x, y, width or info.width, height or info.height


def _require_size(size: tuple[int, int], told: tuple[int, int], what: str) -> None:
    if size != told:
        raise BagError(
            f"{what}: is of images of {told[0]} x {told[1]}, after region and binning, and the image has {size[0]} x "
            f"{size[1]}{exchanged(told, size)}; is it the CameraInfo of another image?"
        )


def _distortion(info: CameraInfo, what: str) -> tuple[float, ...]:
    """OpenCV's coefficients: none, 5 or 8."""
    d: NDArray[np.float64] = info.d
    if not np.isfinite(d).all():
        raise BagError(f"{what}: D is {d.tolist()}, must be finite numbers")
    wanted = MODELS.get(info.model)
    if wanted is None:
        raise BagError(
            f"{what}: distortion model {info.model!r} is not read; plumb_bob and rational_polynomial are. Rectify the "
            "images (image_proc) and record those"
        )
    if not d.any():
        return ()
    if wanted == 0 or d[wanted:].any():
        raise BagError(
            f"{what}: {len(d)} coefficients of distortion model {info.model!r}, {wanted} of them are read"
        )
    return tuple(np.pad(d, (0, max(0, wanted - len(d))))[:wanted].tolist())
