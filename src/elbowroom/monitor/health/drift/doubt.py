"""Whether one image alone says that its camera may be elsewhere: said at once, and confirmed or taken back by the next.

The tests of a watch listen to several images before they name a camera, so that a named one is one. Until then its view
is not trusted: a camera whose newest image contradicts what it was commissioned on is *in doubt*, and contributes
nothing from that pass on. Whoever walks through a view hides what stood still and never lets a camera see through it.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.drift.kernels.watch import FITS_M, FITS_SIGMAS, Gate, Spots
from elbowroom.monitor.health.held import Held

THROUGH = 0.12
"""Where so many of the spots that nothing hides are seen through,"""
OFF = 0.30
"""and so many are not where they were, an image contradicts what was commissioned. People alone never brought the first
above 0.05 in the simulated room."""
GONE = 0.36
"""Where so many are off while it sees through, and it lasts, the camera no longer sees what it was commissioned on."""
WORTH_A_FIT = 0.10
"""From so many on a motion is fitted to this image alone."""
ANOTHERS = 0.25
"""An image is another camera's where of that one's spots so small a part of the share is off that is of its own."""
CLEARS_AFTER = 3
"""So many images in a row that contradict nothing take a doubt back,"""
DECIDES = 30
"""and so many that do, while no test has named the camera: something large was moved that stood still before it."""


class Shares(NamedTuple):
    """Of the spots before which nothing stands.

    Fields:
        shown: how many there are.
        through: the share behind which the camera sees.
        off: the share that is not where it was, nearer or farther.
    """

    shown: int
    through: float
    off: float

    @property
    def contradict(self) -> bool:
        """Whether so many are seen through that what was commissioned cannot be there as it was."""
        return self.through >= THROUGH and self.off >= OFF

    @property
    def gone(self) -> bool:
        """Whether that is so much that the camera is not where it was, or the room is not, if it lasts."""
        return self.contradict and self.off >= GONE


def shares_of(image: NDArray[np.float32], spots: Spots, gate: Gate) -> Shares:
    """What one image shows of the spots.

    Args:
        image: flattened [m]; what is not a number above zero and in range is no return, and says nothing.
        spots: of the reference.
        gate: beyond which what is nearer is another thing that stands before the spot.
    """
    depth = image[spots.pixel].astype(np.float64)
    returned = (depth > 0) & (depth >= gate.least) & (depth <= gate.greatest) & (depth < np.inf)
    off = (np.where(returned, depth, 0.0) - spots.depth) * spots.scale
    shown = returned & (off >= -(gate.off + 4.0 * spots.sigma))
    near = FITS_M + FITS_SIGMAS * spots.sigma
    many = int(np.count_nonzero(shown))
    through = np.count_nonzero(shown & (off > near))
    away = np.count_nonzero(shown & (np.abs(off) > near))
    return Shares(many, through / max(many, 1), away / max(many, 1))


@dataclass(slots=True, eq=False)
class Doubt:
    """What is remembered of the images of one camera."""

    text: str | None = field(default=None, init=False)
    """Why it is in doubt, after its name; None: it is not."""
    _held: Held = field(default_factory=lambda: Held(1, CLEARS_AFTER), init=False)
    _lasted: int = field(default=0, init=False)

    def hear(self, found: str | None, can_tell: bool = True) -> None:
        """One more image.

        Args:
            found: what it contradicts, in words; None: nothing.
            can_tell: whether enough is in view to tell.
        """
        self._held = self._held.hearing(found is not None if can_tell or found is not None else None)
        if not self._held.is_there:
            self.text, self._lasted = None, 0
            return
        self._lasted += found is not None
        self.text = (found or self.text) if self._lasted <= DECIDES else None
