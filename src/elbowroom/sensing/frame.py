"""One depth image of one camera with its time of exposure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError


@dataclass(frozen=True, slots=True, eq=False)
class DepthFrame:
    """A depth image in metres. What is not a finite number above zero is no return.

    Args:
        camera: name of the camera.
        stamp_ns: time of exposure [ns, the clock of the room]; None: unknown, such a frame has no age.
        depth_m: shape (height, width), floating [m], in the camera's kind of depth. Kept as float32,
            read-only.

    Raises:
        FrameError: not a two-dimensional floating image.
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
        depth = np.ascontiguousarray(depth, dtype=np.float32).view()
        depth.setflags(write=False)
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
        return cls(camera=camera, stamp_ns=stamp_ns, depth_m=depth)
