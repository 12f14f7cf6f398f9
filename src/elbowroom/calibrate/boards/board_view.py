"""What one camera saw of the board in one pose."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError


def _none(*shape: int) -> NDArray[np.float64]:
    return np.zeros(shape)


@dataclass(frozen=True, slots=True, eq=False)
class BoardView:
    """Corners and surface of the board as one camera saw them at one pose.

    Args:
        camera: name.
        pose: which pose of the board; the same number in every camera that saw it then.
        corner_ids: of `Board.corners_in_board`, shape (n,), whole numbers, each once.
        corners_px: where they are in the image as it was taken (lens distortion and all), shape (n, 2), u then v [px].
        corner_sigma_px: standard deviation of each coordinate, shape (n,) [px].
        plane_px: pixels of the depth image whose return lies on the board's material, shape (m, 2), u then v [px].
        plane_depth_m: their depth, shape (m,) [m, the camera's kind of depth].
        stamp_ns: time of exposure [ns]; None: not known.

    Raises:
        CalibrationError: shapes that do not go together, or values that are not finite.
    """

    camera: str
    pose: int
    corner_ids: NDArray[np.int64]
    corners_px: NDArray[np.float64]
    corner_sigma_px: NDArray[np.float64]
    plane_px: NDArray[np.float64] = field(default_factory=lambda: _none(0, 2))
    plane_depth_m: NDArray[np.float64] = field(default_factory=lambda: _none(0))
    stamp_ns: int | None = None

    def __post_init__(self) -> None:
        ids = np.array(self.corner_ids, dtype=np.int64)
        ids.setflags(write=False)
        object.__setattr__(self, "corner_ids", ids)
        n, m = len(ids), len(self.plane_depth_m)
        if len(np.unique(ids)) != n:
            raise CalibrationError(
                f"camera {self.camera}, pose {self.pose}: a corner is there more than once"
            )
        for name, shape in (
            ("corners_px", (n, 2)),
            ("corner_sigma_px", (n,)),
            ("plane_px", (m, 2)),
            ("plane_depth_m", (m,)),
        ):
            values = np.array(getattr(self, name), dtype=np.float64)
            if values.shape != shape or not np.isfinite(values).all():
                raise CalibrationError(
                    f"camera {self.camera}, pose {self.pose}: {name} has shape {values.shape}, "
                    f"must be {shape} of finite numbers"
                )
            values.setflags(write=False)
            object.__setattr__(self, name, values)
