"""What cameras see of the room with its things and nobody in it, camera by camera, so that one can be moved alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.stale import Stop, unless
from elbowroom.placement.detection import Capability, needs
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.sight import sights
from elbowroom.placement.verification import Verification, judge

AT_ONCE = 8
"""So many cameras are looked through before it is asked whether anybody still wants to know."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What one camera sees.

    Args:
        camera: kept, so that no other one takes its place in memory.
        seen: bool, shape of the grid.
        need_m: how thick an object must be where it is seen, float32, shape of the grid; infinite elsewhere [m].
    """

    camera: DepthCamera
    seen: NDArray[np.bool_]
    need_m: NDArray[np.float32]


@dataclass(slots=True, eq=False)
class SeenRoom:
    """Sights of cameras, kept until the camera or a thing of the room is elsewhere.

    Args:
        ground: the room.
        grid: whose voxels are seen or not.
    """

    ground: Ground
    grid: VoxelGrid
    _things: object = field(default=None, init=False)
    _fixed: FixedRoom | None = field(default=None, init=False)
    _asked: NDArray[np.bool_] | None = field(default=None, init=False)
    _known: dict[int, Seen] = field(default_factory=dict, init=False)
    _judged: tuple[list[DepthCamera], Verification] | None = field(default=None, init=False)
    """Of which cameras, and what came of them."""
    _needed: tuple[tuple[float, float], float] | None = field(default=None, init=False)

    def verified(self, layout: Layout, is_stale: Stop) -> Verification:
        """The same as `placement.verify` says.

        Args:
            layout: with at least one camera.
            is_stale: asked before each camera that is not known.

        Raises:
            CameraError: a camera inside something fixed.
            InputError: no voxel that is not inside something fixed.
            Stale: nobody wants to know any more.
        """
        asked = self._settled(layout)
        if not asked.any():
            raise InputError("plan: the watched box lies wholly inside walls or furniture")
        self._look(layout, is_stale)
        known = [self._known[id(placed.camera)] for placed in layout.cameras]
        self._known = {id(one.camera): one for one in known}
        cameras = [one.camera for one in known]
        if self._judged is not None and _are_same(
            cameras, self._judged[0]
        ):  # a person or the machine has moved
            return self._judged[1]
        unless(is_stale)
        seen = np.stack([one.seen for one in known])
        found = judge(self.grid, cameras, seen, asked.copy(), self.ground.requirement)
        self._judged, self._needed = (cameras, found), None
        return found

    def smallest_mm(self, layout: Layout, percent: float, edge_m: float) -> float:
        """As `placement.capability` of one view has it: what is seen at so many of all places [mm].

        Args:
            layout: that was verified last.
            percent: of the places [%].
            edge_m: of the voxels that things are told apart from in the end [m].
        """
        asked = percent, edge_m
        if self._needed is None or self._needed[0] != asked:
            self._needed = asked, self._smallest_mm(layout, percent, edge_m)
        return self._needed[1]

    def _smallest_mm(self, layout: Layout, percent: float, edge_m: float) -> float:
        known = [self._known[id(placed.camera)] for placed in layout.cameras]
        whole = np.minimum.reduce([one.need_m for one in known])
        whole = np.float32(1000) * np.maximum(whole, np.float32(edge_m * math.sqrt(3.0)))
        assert self._asked is not None
        return Capability(self.grid, 1, whole, whole, whole, self._asked).percentile_mm(percent)

    def _settled(self, layout: Layout) -> NDArray[np.bool_]:
        """Lets go of what no longer holds where a thing is elsewhere; which voxels are asked."""
        if self._asked is None or self._things is not layout.things:
            self._things, self._fixed = layout.things, self.ground.fixed_with(layout)
            self._known.clear()
            self._judged = None
            shape = self.grid.shape
            self._asked = np.ones(shape, bool) if self._fixed is None else ~self._fixed.occupied(self.grid)
        return self._asked

    def _look(self, layout: Layout, is_stale: Stop) -> None:
        """Looks through the cameras that are not known yet."""
        missing = [placed.camera for placed in layout.cameras if id(placed.camera) not in self._known]
        for first in range(0, len(missing), AT_ONCE):
            unless(is_stale)
            some = missing[first : first + AT_ONCE]
            for camera, seen in zip(some, sights(self.grid, some, self._fixed), strict=True):
                need = np.full(self.grid.shape, np.inf, dtype=np.float32)
                need[seen] = np.maximum(*needs(camera, self.grid.centre_of(np.argwhere(seen))))
                self._known[id(camera)] = Seen(camera, seen, need)


def _are_same(one: Sequence[DepthCamera], other: Sequence[DepthCamera]) -> bool:
    """Whether these are the same cameras, and not only alike."""
    return len(one) == len(other) and all(a is b for a, b in zip(one, other, strict=True))
