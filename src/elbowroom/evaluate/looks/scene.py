"""What looks are asked about: a grid, its cameras, and the images of one moment, as a site brings them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct.looking import found_at
from elbowroom.sensing import DepthFrame

Codes = NDArray[np.uint16]
MOST = 65534


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One moment of a site.

    Args:
        name: of the site.
        grid: the watched box.
        cameras: as the site says them.
        codes: raw 16-bit image of each, shape (height, width).
        units_m: metres per unit as the site says, by camera.
    """

    name: str
    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    codes: Mapping[str, Codes]
    units_m: Mapping[str, float]

    @property
    def frames(self) -> list[DepthFrame]:
        """The frames, as the site's images are read."""
        return [
            DepthFrame.from_raw(name, None, codes, scale_m=self.units_m[name])
            for name, codes in self.codes.items()
        ]

    def findings(self) -> tuple[Finding, ...]:
        """What all looks find. Contradictions between cameras belong here as well as values."""
        return found_at(self.grid, self.cameras, self.frames, self.units_m)


def as_codes(depth_m: NDArray[np.floating], unit_m: float) -> Codes:
    """Depth in whole units, 0 where there is no return or it is too far, shape (height, width)."""
    units = np.rint(np.where(np.isfinite(depth_m), depth_m, 0.0) / unit_m)
    return np.where((units <= MOST) & (units > 0), units, 0).astype(np.uint16)
