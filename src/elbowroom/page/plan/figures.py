"""The figures of a layout: how much is seen, how well, what a scene would be found to be, what it costs."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.page.plan.found import FoundScene
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.price import price_of
from elbowroom.page.plan.seen import SeenRoom
from elbowroom.page.plan.stale import Stop, never
from elbowroom.placement.verification import Verification
from elbowroom.reconstruct import FreeSpace

COARSE_VOXELS, EXACT_VOXELS = 40_000, 400_000
"""Voxels are made larger until there are no more of them than that."""
SHARE_PCT = 90.0
"""The smallest object is told that is seen at so many of all places [%]."""


@dataclass(frozen=True, slots=True)
class Figures:
    """What a layout comes to.

    Args:
        seen_pct: share of the places that at least one camera sees [%].
        valid_pct: share that meets the requirement [%].
        smallest_mm: thickness of the smallest object that some camera sees, at `SHARE_PCT` of the places [mm].
        free_pct: of what is truly free in the scene as it stands, how much is found [%].
        price: of all cameras, in whatever money the site counts in.
        cameras: how many there are.
        is_exact: by the site's own voxels and all pixels; False: a first answer.
        voxel_size_m: by which it was reckoned [m].
    """

    seen_pct: float
    valid_pct: float
    smallest_mm: float
    free_pct: float
    price: float
    cameras: int
    is_exact: bool
    voxel_size_m: float

    def row(self) -> dict[str, Any]:
        """A row of kind "plan"."""
        names = ("seen_pct", "valid_pct", "smallest_mm", "free_pct", "price", "cameras", "is_exact")
        return {"kind": "plan", **{name: getattr(self, name) for name in (*names, "voxel_size_m")}}


@dataclass(slots=True, eq=False)
class Reckoner:
    """Figures of layouts of one room; what has not changed since the last one is not reckoned again.

    Args:
        ground: the room.
        is_exact: by the site's voxels and all pixels; False: coarsely.
    """

    ground: Ground
    is_exact: bool
    grid: VoxelGrid = field(init=False)
    newest: Verification | None = field(default=None, init=False)
    """What is seen of the empty room, of the last figures."""
    space: FreeSpace | None = field(default=None, init=False)
    """What is found of the scene, of the last figures."""
    _room: SeenRoom = field(init=False)
    _scene: FoundScene = field(init=False)

    def __post_init__(self) -> None:
        self.grid = no_more_than(EXACT_VOXELS if self.is_exact else COARSE_VOXELS, self.ground.grid)
        self._room = SeenRoom(self.ground, self.grid)
        self._scene = FoundScene(self.ground, self.grid, self.is_exact)

    def figures(self, layout: Layout, is_stale: Stop = never) -> Figures:
        """The figures of a layout.

        Args:
            layout: any of this room.
            is_stale: asked now and then whether nobody wants to know any more.

        Raises:
            CameraError: a camera inside something fixed.
            Stale: nobody does.
        """
        if not layout.cameras:
            self.newest = self.space = None
            return Figures(0.0, 0.0, math.inf, 0.0, 0.0, 0, self.is_exact, self.grid.voxel_size_m)
        found = self._room.verified(layout, is_stale)
        smallest_mm = self._room.smallest_mm(
            layout, SHARE_PCT, no_more_than(EXACT_VOXELS, self.ground.grid).voxel_size_m
        )
        space, free_pct = self._scene.found(layout, is_stale)
        self.newest, self.space = found, space
        return Figures(
            seen_pct=found.seen_pct(1),
            valid_pct=found.valid_pct,
            smallest_mm=smallest_mm,
            free_pct=free_pct,
            price=price_of(self.ground, layout),
            cameras=len(layout.cameras),
            is_exact=self.is_exact,
            voxel_size_m=self.grid.voxel_size_m,
        )


def no_more_than(most: int, whole: VoxelGrid) -> VoxelGrid:
    """The same box in voxels as large as needed.

    Args:
        most: about so many voxels.
        whole: the box.
    """
    edge = float((np.prod(whole.upper_m - whole.lower_m) / most) ** (1 / 3))
    # a last layer more is no reason for larger ones
    if edge <= 1.02 * whole.voxel_size_m:
        return whole
    return VoxelGrid.covering(whole.lower_m, whole.upper_m, edge)
