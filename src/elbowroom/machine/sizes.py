"""Whether what is laid about a machine has a size and a place in metres: parts that it carries, things, zones."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError

LARGEST_LINK_M = 20.0
"""A longer link is refused, unless the site says otherwise [m]."""
LARGEST_MESH_M = 100.0
"""A longer mesh of a thing or a zone is refused: those that stand in a hall are shorter [m]."""
SUSPECT_M, ODD = 2.0, 10.0
"""A part that is longer, or farther away, than this and than so many times the longest link is said [m]."""
SMALLEST_M = 0.001
"""A smaller mesh is said: it may have been scaled twice [m]."""


def require_metres(what: str, points: NDArray[np.float64], largest_m: float, key: str = "") -> None:
    """Refuses what is so long that its numbers must be of another unit.

    Args:
        what: names it in the message.
        points: its corners, shape (n, 3) [m].
        largest_m: the longest that may be [m].
        key: that scales it; "": none does, and its file must be in metres.

    Raises:
        MachineError: it is longer.
    """
    length = length_of(points)
    if length > largest_m:
        factor = 0.001 if length / 1000 > 0.002 else 0.01
        meant = f"{key} {factor:g}" if key else f"a mesh that is scaled by {factor:g}"
        raise MachineError(
            f"{what}: is {length:.4g} m long, at most {largest_m:g} m may be; is it in millimetres? {meant} makes it "
            f"{length * factor:.3g} m"
        )


def length_of(points: NDArray[np.float64]) -> float:
    """The longest edge of the box that holds points [m]."""
    return float(np.ptp(points, axis=0).max())


def away_of(points: NDArray[np.float64]) -> float:
    """How far the box that holds points lies from its frame's origin [m]."""
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(points.min(axis=0), -points.max(axis=0)))))
