"""What a camera's images of the machine say of its pose: normal equations, pose by pose."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.kernels.surface import (
    AGREES,
    BEFORE,
    BEHIND,
    SEEN,
    SILENT,
    DepthError,
    Sums,
    Trust,
    compare,
)
from elbowroom.calibrate.from_machine.views import MachineViews
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

BIAS_SIGMA_M, SCALE_SIGMA = 0.005, 0.005
"""How far a sensor's depth may be off before anything is known [m, 1]."""
DEPTH_ERRORS = slice(6, 8)
"""Bias and scale among the eight unknowns of a camera."""

Array = NDArray[np.float64]


class SurfaceSums(NamedTuple):
    """Of all images of one camera.

    normal, gradient: shapes (n, 8, 8) and (n, 8), by image; twist of the camera in its own frame, then bias and scale
        of its depth; residuals in sigmas.
    depth_error: the bias [m] and scale at which this was looked at, shape (2,).
    counts: shape (n, 5), pixels by image: judged, agreeing, farther, nearer, without return.
    cost: robust cost of all.
    residuals: measured minus drawn depth of the pixels that agree, shape (n, height, width) [m]; NaN elsewhere.
    """

    normal: Array
    gradient: Array
    depth_error: Array
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
    drawn: DrawnMachine,
    views: MachineViews,
    world_from_camera: Array,
    depth_error: Array,
    trust: Trust = TRUST,
) -> SurfaceSums:
    """Compares all images of a camera with the machine drawn into them.

    Args:
        drawn: the machine.
        views: of the camera.
        world_from_camera: where the camera is taken to be, shape (4, 4).
        depth_error: bias [m] and scale of its depth, shape (2,).
        trust: which pixels count.
    """
    error = DepthError(float(depth_error[0]), float(depth_error[1]))
    camera = views.images.at(world_from_camera)
    view, count = view_of(camera), len(views.poses)
    normal, gradient = np.zeros((count, 8, 8)), np.zeros((count, 8))
    counts = np.zeros((count, 5), dtype=np.int64)
    residuals = np.full(views.images.depth_m.shape, np.nan, dtype=np.float32)
    cost = 0.0
    for row, (links, measured) in enumerate(zip(views.base_from_links, views.images.depth_m, strict=True)):
        sums = Sums(normal[row], gradient[row], counts[row], residuals[row])
        cost += compare(view, drawn.image(camera, links), measured, error, trust, sums)
    return SurfaceSums(normal, gradient, np.array(error), counts, cost, residuals)


def whole(sums: SurfaceSums) -> tuple[Array, Array]:
    """Normal equations of all images of a camera and of what is known of its depth, shapes (8, 8) and (8,)."""
    normal, gradient = sums.normal.sum(axis=0), sums.gradient.sum(axis=0)
    weight = np.array([BIAS_SIGMA_M, SCALE_SIGMA]) ** -2.0
    normal[DEPTH_ERRORS, DEPTH_ERRORS] += np.diag(weight)
    gradient[DEPTH_ERRORS] += weight * sums.depth_error
    return normal, gradient


def of_pose(normal: Array, gradient: Array) -> tuple[Array, Array]:
    """What eight equations say of the pose alone, whatever the depth is off by: shapes (6, 6) and (6,)."""
    carried = np.linalg.solve(normal[DEPTH_ERRORS, DEPTH_ERRORS], normal[DEPTH_ERRORS, :6]).T
    return normal[:6, :6] - carried @ normal[DEPTH_ERRORS, :6], gradient[:6] - carried @ gradient[
        DEPTH_ERRORS
    ]


def depth_error_step(normal: Array, gradient: Array, twist: Array) -> Array:
    """How bias and scale follow when the pose moves by a twist, shape (2,).

    Args:
        normal, gradient: of pose and depth error together, shapes (8, 8) and (8,).
        twist: of the pose, shape (6,) [rad, m].
    """
    left = gradient[DEPTH_ERRORS] + normal[DEPTH_ERRORS, :6] @ twist
    return -np.asarray(np.linalg.solve(normal[DEPTH_ERRORS, DEPTH_ERRORS], left))
