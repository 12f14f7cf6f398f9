"""What a camera measured beside what it should have measured: for the report."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class SurfacePicture:
    """Two depth images of one view.

    Args:
        camera: name.
        title: what is seen, such as "pose 3".
        measured_m: shape (height, width) [m]; 0: no return.
        expected_m: the same of the model, or of what the other cameras see; 0: nothing is expected.
        agrees: pixels that took part in the fit, shape (height, width), bool.
    """

    camera: str
    title: str
    measured_m: NDArray[np.float32]
    expected_m: NDArray[np.float32]
    agrees: NDArray[np.bool_]

    def __post_init__(self) -> None:
        for name in ("measured_m", "expected_m", "agrees"):
            array = np.array(getattr(self, name))
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def difference_m(self) -> NDArray[np.float32]:
        """Measured minus expected where both are there, NaN elsewhere [m]."""
        both = (self.measured_m > 0) & (self.expected_m > 0)
        return np.where(both, self.measured_m - self.expected_m, np.float32(np.nan)).astype(np.float32)
