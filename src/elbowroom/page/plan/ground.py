"""What stays while planning: the site, its room, its machine, what is asked of a layout and what it may cost."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.page.plan.layout import Layout, PlacedCamera
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.requirement import Requirement, requirement_of
from elbowroom.placement.sensor import Sensor, known_sensors, sensors_of
from elbowroom.reconstruct import Terms
from elbowroom.simulate import Moment
from elbowroom.simulate.floor import floor_height
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.site import Site
from elbowroom.site.placement_entry import PlacementEntry, PricesEntry
from elbowroom.sources.cameras import cameras_of

OWN = "as in the site"
"""The kind of cameras that are none of the site's sensors."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What stays.

    Args:
        site: the file.
        grid: the watched box.
        room: walls and furniture; None: the site describes none.
        machine: None: there is none.
        requirement: what every point must have.
        terms: how space is declared free.
        sensors: kinds that can be chosen.
        prices: of mounts and cables.
    """

    site: Site
    grid: VoxelGrid
    room: FixedRoom | None
    machine: Machine | None
    requirement: Requirement
    terms: Terms
    sensors: tuple[Sensor, ...]
    prices: PricesEntry
    floor_m: float = field(init=False)

    def __post_init__(self) -> None:
        solids = () if self.room is None else self.room.solids
        walls = None if self.room is None else self.room.walls_m
        floor = floor_height(self.grid, solids) if walls is None else float(walls[0, 2])
        object.__setattr__(self, "floor_m", floor)

    @classmethod
    def of(cls, site: Site, voxel_size_m: float | None = None) -> "Ground":
        """What stays of a site.

        Args:
            site: the file.
            voxel_size_m: edge of a voxel instead of the site's [m].

        Raises:
            InputError: a room, a machine or a sensor that cannot be read.
        """
        given = site.entry.placement or PlacementEntry()
        return cls(
            site,
            site.grid(voxel_size_m),
            FixedRoom.of_site(site),
            site.machine(),
            requirement_of(site),
            site.terms(),
            _sensors(site),
            given.prices,
        )

    def first_layout(self) -> Layout:
        """The layout that the site describes: its cameras, if it has any, and the machine near its zero."""
        has_cameras = self.site.simulated is not None or self.site.lists_cameras
        cameras = cameras_of(self.site) if has_cameras else ()
        joints = {} if self.machine is None else self.machine.nearest_to_zero()
        return Layout(tuple(PlacedCamera(one, self.kind_of(one)) for one in cameras), joints)

    def kind_of(self, camera: DepthCamera) -> str:
        """The name of the sensor that a camera is, or `OWN`."""
        for sensor in self.sensors:
            if _same_kind(camera, sensor.camera):
                return sensor.name
        return OWN

    @property
    def has_prices(self) -> bool:
        """Whether the site says of anything what it costs."""
        given = self.site.entry.placement
        if given is None:
            return False
        named = [*given.sensors, *given.mounts, given.prices]
        keys = {"price", "mount", "cable_per_m"}
        return any(keys & entry.model_fields_set for entry in named)

    @property
    def box_m(self) -> NDArray[np.float64]:
        """Within which things can be: walls, else the watched box, shape (2, 3), world frame [m]."""
        if self.room is not None and self.room.walls_m is not None:
            return self.room.walls_m
        return np.stack([self.grid.lower_m, self.grid.upper_m])

    def fixed_with(self, layout: Layout) -> FixedRoom | None:
        """The room with the things that were placed in it.

        Args:
            layout: whose things.
        """
        if not layout.things:
            return self.room
        solids = list(chain.from_iterable(thing.solids() for thing in layout.things))
        base = self.room or FixedRoom()
        closed = tuple(solid for solid in solids if solid.has_inside)
        opened = tuple(solid for solid in solids if not solid.has_inside)
        return FixedRoom(
            base.solids + closed, base.surfaces + opened, base.walls_m, base.notes, base.from_mesh
        )

    def moment_of(self, layout: Layout, fixed: FixedRoom | None) -> Moment:
        """All that is there: room, things, people and machine.

        Args:
            layout: where it is.
            fixed: of `fixed_with`.
        """
        solids = () if fixed is None else fixed.moment.solids
        people = tuple(chain.from_iterable(one.solids(self.floor_m) for one in layout.people))
        links = () if self.machine is None else link_solids(self.machine, layout.joints)
        return Moment(1.0, solids + people + links, dict(layout.joints))


def _sensors(site: Site) -> tuple[Sensor, ...]:
    """Kinds of the site, then those of the package that have another name."""
    own: Sequence[Sensor] = ()
    try:
        own = sensors_of(site)
    except SiteError:
        # where it lists sensors it has to say what they are; where it lists none, those of the package are left
        if site.entry.placement is not None and site.entry.placement.sensors:
            raise
    names = {sensor.name for sensor in own}
    return (*own, *(sensor for name, sensor in known_sensors().items() if name not in names))


def _same_kind(one: DepthCamera, other: DepthCamera) -> bool:
    """Whether two cameras differ in name and place alone."""
    keys = ("width", "height", "intrinsics", "depth_kind", "noise", "min_depth_m", "max_depth_m")
    return all(getattr(one, key) == getattr(other, key) for key in keys)
