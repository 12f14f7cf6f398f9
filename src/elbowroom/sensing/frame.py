"""One depth image of one camera with its time of exposure."""

import operator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError

FARTHEST_M = 100.0
"""No depth camera measures half of its image beyond this [m]."""
GLANCE = 4096
"""About so many pixels of an image are looked at to tell metres from millimetres."""


@dataclass(frozen=True, slots=True, eq=False)
class DepthFrame:
    """A depth image in metres. What is not a finite number above zero is no return.

    It is what it was when it was made: pixels are copied, since drivers fill their buffers again. An array that owns
    its pixels and was made read-only is kept as it is.

    Args:
        camera: name of the camera.
        stamp_ns: time of exposure [ns, the clock of the room]; None: unknown, such a frame has no age.
        depth_m: shape (height, width), floating [m], in the camera's kind of depth. Kept as float32,
            read-only.

    Raises:
        FrameError: not a two-dimensional floating image, a time that is no whole number, or most of its depths are
            hundreds of metres.
    """

    camera: str
    stamp_ns: int | None
    depth_m: NDArray[np.float32]

    def __post_init__(self) -> None:
        depth = np.asarray(self.depth_m)
        if depth.ndim != 2 or depth.dtype.kind != "f":
            raise FrameError(
                f"frame of {self.camera}: expected a floating image (height, width) in metres, got "
                f"{depth.dtype} {depth.shape}; whole numbers go through DepthFrame.from_raw with their scale"
            )
        if not _is_fixed(depth):
            depth = np.array(depth, dtype=np.float32, order="C")
            depth.setflags(write=False)
        _refuse_millimetres(self.camera, depth)
        object.__setattr__(self, "stamp_ns", _whole(self.camera, self.stamp_ns))
        object.__setattr__(self, "depth_m", depth)

    @classmethod
    def from_raw(
        cls,
        camera: str,
        stamp_ns: int | None,
        raw: NDArray[np.uint16],
        *,
        scale_m: float,
        bias_m: float = 0.0,
    ) -> "DepthFrame":
        """From a sensor's whole numbers; 0 and 65535 are no return.

        Args:
            camera: name of the camera.
            stamp_ns: time of exposure [ns]; None: unknown.
            raw: shape (height, width), uint16.
            scale_m: metres per unit, 0.001 for millimetres.
            bias_m: is added to each depth [m]; what falls to zero or below by it is no return.

        Raises:
            FrameError: another type, or a scale that is not above zero.
        """
        if raw.dtype != np.uint16:
            raise FrameError(f"frame of {camera}: expected uint16, got {raw.dtype}; 16-bit depth images only")
        if not (np.isfinite(scale_m) and scale_m > 0):
            raise FrameError(f"frame of {camera}: scale_m is {scale_m}, must be above 0 [m per unit]")
        if not np.isfinite(bias_m):
            raise FrameError(f"frame of {camera}: bias_m is {bias_m}, must be a finite number [m]")
        depth = raw.astype(np.float32) * np.float32(scale_m)
        if bias_m:
            depth = np.maximum(depth + np.float32(bias_m), 0)
        depth[(raw == 0) | (raw == 65535)] = 0
        depth.setflags(write=False)
        return cls(camera=camera, stamp_ns=stamp_ns, depth_m=depth)


def _whole(camera: str, stamp_ns: object) -> int | None:
    """A time as a whole number; raises FrameError where it is another kind of value: seconds are floats."""
    if stamp_ns is None or type(stamp_ns) is int:
        return stamp_ns
    try:
        return operator.index(stamp_ns)  # type: ignore[arg-type]
    except TypeError:
        raise FrameError(
            f"frame of {camera}: stamp_ns is {stamp_ns!r}, must be whole nanoseconds, as time.time_ns() gives them"
        ) from None


def _is_fixed(depth: NDArray[np.floating]) -> bool:
    """Whether nobody else can write into an array of the kind that is kept."""
    kept = depth.dtype == np.float32 and depth.flags.c_contiguous and type(depth) is np.ndarray
    return bool(kept and depth.flags.owndata and not depth.flags.writeable)


def _refuse_millimetres(camera: str, depth: NDArray[np.float32]) -> None:
    """Raises FrameError where most of the returns lie hundreds of metres away."""
    step = max(1, int((depth.size / GLANCE) ** 0.5))
    some = depth[::step, ::step]
    far = int(np.count_nonzero((some > FARTHEST_M) & (some < np.inf)))
    if 2 * far <= np.count_nonzero((some > 0) & (some < np.inf)):
        return
    median = float(np.median(some[(some > 0) & (some < np.inf)]))
    raise FrameError(
        f"frame of {camera}: half of its depths are {median:.4g} m or more, depth_m is in metres; these look like "
        f"millimetres ({median / 1e3:.3g} m): divide by 1000, or take DepthFrame.from_raw with scale_m"
    )
