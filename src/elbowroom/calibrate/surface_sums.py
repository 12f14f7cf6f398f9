"""What a camera's images of the machine say of its pose: normal equations, pose by pose."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate._kernels_surface import AGREES, BEFORE, BEHIND, SEEN, SILENT, Trust, compare
from elbowroom.calibrate.drawn_machine import DrawnMachine
from elbowroom.calibrate.machine_capture import MachineViews
from elbowroom.machine.rasterise import view_of

MODEL_SIGMA_M = 0.002
"""How well a machine's model fits the real one, unless said otherwise [m]."""
TRUST = Trust(
    border=1,
    step_m=0.03,
    least_cosine=0.25,
    floor_m=MODEL_SIGMA_M,
    lateral_px=0.25,
    widening_m=0.0,
    reach=4.7,
)
"""Pixels near a step are left out: the sensor mixes both sides there. So are grazed ones. Tukey's usual reach."""

Array = NDArray[np.float64]


class SurfaceSums(NamedTuple):
    """Of all images of one camera.

    normal, gradient: shapes (n, 6, 6) and (n, 6), by image; twist of the camera in its own frame, residuals in sigmas.
    counts: shape (n, 5), pixels by image: judged, agreeing, farther, nearer, without return.
    cost: robust cost of all.
    residuals: measured minus drawn depth of the pixels that agree, shape (n, height, width) [m]; NaN elsewhere.
    """

    normal: Array
    gradient: Array
    counts: NDArray[np.int64]
    cost: float
    residuals: NDArray[np.float32]

    @property
    def seen(self) -> int:
        """Pixels of the machine that were judged."""
        return int(self.counts[:, SEEN].sum())

    @property
    def agreeing(self) -> int:
        """Of them, pixels whose depth agrees with the model."""
        return int(self.counts[:, AGREES].sum())

    @property
    def behind(self) -> int:
        """Of them, pixels that see through the model: there the machine is not where it should be."""
        return int(self.counts[:, BEHIND].sum())

    @property
    def before(self) -> int:
        """Of them, pixels where something stands before the machine."""
        return int(self.counts[:, BEFORE].sum())

    @property
    def silent(self) -> int:
        """Of them, pixels without return."""
        return int(self.counts[:, SILENT].sum())


def surface_sums(
    drawn: DrawnMachine, views: MachineViews, world_from_camera: Array, trust: Trust = TRUST
) -> SurfaceSums:
    """Compares all images of a camera with the machine drawn into them.

    Args:
        drawn: the machine.
        views: of the camera.
        world_from_camera: where the camera is taken to be, shape (4, 4).
        trust: which pixels count.
    """
    camera = views.images.at(world_from_camera)
    view, count = view_of(camera), len(views.poses)
    normal, gradient = np.zeros((count, 6, 6)), np.zeros((count, 6))
    counts = np.zeros((count, 5), dtype=np.int64)
    residuals = np.full(views.images.depth_m.shape, np.nan, dtype=np.float32)
    cost = 0.0
    for row, (links, measured) in enumerate(zip(views.base_from_links, views.images.depth_m, strict=True)):
        drawing = drawn.image(camera, links)
        cost += compare(
            view, *drawing, measured, trust, normal[row], gradient[row], counts[row], residuals[row]
        )
    return SurfaceSums(normal, gradient, counts, cost, residuals)
