"""What cameras find of the scene as it stands, carved by the code that runs; camera by camera."""

from dataclasses import dataclass, field

import numpy as np

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.stale import Stop, unless
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.rehearsal import Settings, evidence_by_camera
from elbowroom.reconstruct import Evidence, FreeSpace
from elbowroom.reconstruct.resolve import decide
from elbowroom.reconstruct.witnesses import merged_by_witness, witnesses
from elbowroom.simulate import Moment, true_occupancy

COARSE_PX = 80
"""For a first answer, pixels are joined as long as so many stay across."""
AT_ONCE = 8
"""So many cameras are asked before it is looked whether anybody still wants to know."""
SEED = 1
"""Of the sensors' noise, which differs by the camera's name."""
Scene = tuple[object, object, tuple[tuple[str, float], ...]]


@dataclass(slots=True, eq=False)
class FoundScene:
    """Evidence of cameras, kept until the camera or anything in the scene is elsewhere.

    Args:
        ground: the room.
        grid: whose voxels are found free or not.
        is_exact: with all pixels; False: with joined ones.
    """

    ground: Ground
    grid: VoxelGrid
    is_exact: bool
    _scene: Scene | None = field(default=None, init=False)
    _moment: Moment | None = field(default=None, init=False)
    _truly_free: Words = field(init=False)
    _known: dict[int, tuple[DepthCamera, Evidence]] = field(default_factory=dict, init=False)

    _coarse: dict[int, tuple[DepthCamera, DepthCamera]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self._truly_free = bits.empty(self.grid)

    def found(self, layout: Layout, is_stale: Stop) -> tuple[FreeSpace, float]:
        """The space that is found, and which share of the truly free space that is [%].

        Args:
            layout: with at least one camera.
            is_stale: asked before each camera that is not known.

        Raises:
            Stale: nobody wants to know any more.
        """
        moment = self._settled(layout)
        cameras = [placed.camera for placed in layout.cameras]
        used = [camera if self.is_exact else self._joined(camera) for camera in cameras]
        known = {id(one): self._known[id(one)] for one in cameras if id(one) in self._known}
        missing = [number for number, camera in enumerate(cameras) if id(camera) not in known]
        for first in range(0, len(missing), AT_ONCE):
            unless(is_stale)
            some = missing[first : first + AT_ONCE]
            settings = Settings(self.grid, self.ground.terms, self.ground.machine)
            parts = evidence_by_camera([used[number] for number in some], moment, settings, SEED)
            for number, evidence in zip(some, parts, strict=True):
                known[id(cameras[number])] = self._known[id(cameras[number])] = (cameras[number], evidence)
        self._known = known
        self._coarse = {key: pair for key, pair in self._coarse.items() if key in known}
        terms, machine = self.ground.terms, self.ground.machine
        groups = witnesses(self.grid, tuple(used), terms.witness_angle_deg)
        merged = merged_by_witness([known[id(camera)][1] for camera in cameras], groups)
        space = decide(merged, used, machine, moment.joints, terms)
        true = max(_count(self._truly_free), 1)
        return space, 100.0 * _count(space.free_words & self._truly_free) / true

    def _joined(self, camera: DepthCamera) -> DepthCamera:
        """The camera with fewer pixels, the same each time, so that what was made for it is kept."""
        if id(camera) not in self._coarse:
            self._coarse[id(camera)] = camera, with_joined_pixels(camera, COARSE_PX)
        return self._coarse[id(camera)][1]

    def _settled(self, layout: Layout) -> Moment:
        """All that is there; lets go of what no longer holds."""
        scene = (layout.things, layout.people, tuple(sorted(layout.joints.items())))
        same = self._scene is not None and all(
            one is other or one == other for one, other in zip(scene, self._scene, strict=True)
        )
        if self._moment is None or not same:
            self._scene = scene
            self._moment = self.ground.moment_of(layout, self.ground.fixed_with(layout))
            truth = true_occupancy(self.grid, self._moment)
            self._truly_free = bits.pack(~truth.occupied & ~truth.machine, self.grid)
            self._known.clear()
        return self._moment


def _count(words: Words) -> int:
    """Number of voxels in a plane."""
    return int(np.unpackbits(words.view(np.uint8)).sum())
