"""A look at whether anything that stands in the grid is seen: at the first moments, and as long as nothing is.

And, once, at how much depths scatter.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.nothing_seen import nothing_seen
from elbowroom.sensing import Snapshot
from elbowroom.sensing.values.scatter import look_at_scatter

FIRST = 3
"""At so many moments with frames it is asked, and until one was right; while it stops, at each."""


@dataclass(slots=True, eq=False)
class NothingLook:
    """Stops while all reads free, nothing ends in the grid, and nobody vouches for the depths (`Look`).

    Args:
        grid: the watched box.
        cameras: of the room.
        margin: of cameras without one of their own.
    """

    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    margin: Margin
    name: str = "surfaces"
    found: tuple[Finding, ...] = field(default=(), init=False)
    heard: int = field(default=0, init=False)
    asks: bool = field(default=True, init=False)
    scatter: tuple[Finding, ...] | None = field(default=None, init=False)

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """What is found by now."""
        if snapshot.frames and self.asks:
            stopped = bool(self.found)
            self.found = nothing_seen(self.grid, self.cameras, snapshot.frames, self.margin)
            self.heard += 1
            # once something was seen where nothing was, the depths are depths
            self.asks = bool(self.found) or (self.heard < FIRST and not stopped)
        if snapshot.frames and self.scatter is None and not self.found:
            self.scatter = look_at_scatter(self.cameras, snapshot.frames, self.margin)
        return (*self.found, *(self.scatter or ()))
