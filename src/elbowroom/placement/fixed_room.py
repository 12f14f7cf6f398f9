"""What of a room never moves: floor, walls, ceiling and fixed furniture, as solids that block sight."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError, InputError, SiteError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.simulate import InterventionRoom, Moment, Solid, true_occupancy
from elbowroom.simulate.kernels.touch import touch_surface
from elbowroom.simulate.room_mesh import RoomMesh, listed, read_room_mesh
from elbowroom.simulate.setups import SETUPS, setup
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Mesh
from elbowroom.simulate.truth import SHRINK_M, touched_by
from elbowroom.site import Site
from elbowroom.site.room_entry import RoomEntry

WALL_M = 0.2
"""Thickness of walls made from their inner faces [m]."""
SPECK_M = 1e-4
"""A camera inside a solid by more than about this is refused [m]."""
INNER_WALLS_M = np.array([[-2.05, -2.05, 0.0], [2.05, 2.05, 2.9]])
"""Inner faces of the walls of the simulated room and of the setups, least and greatest corner [m]."""
SETUP_NAMES = tuple(shipped.name for shipped in SETUPS)
"""What a site file may write as `room.mesh` for a room of the package."""


@dataclass(frozen=True, eq=False)
class FixedRoom:
    """Solids that never move, and the inner faces of the walls if they are known.

    Args:
        solids: closed ones: floor, walls, ceiling, furniture.
        surfaces: meshes that are not closed, or closed about the room itself: they block sight and have no inside.
        walls_m: inner faces, least and greatest corner, shape (2, 3), world frame [m]; None: not known.
        notes: what a person should know of how the room's mesh was read, a line each.
        from_mesh: those of both that come from the room's mesh, and not from its walls and furniture.
    """

    solids: tuple[Solid, ...] = ()
    surfaces: tuple[Solid, ...] = ()
    walls_m: NDArray[np.float64] | None = None
    notes: tuple[str, ...] = ()
    from_mesh: tuple[Solid, ...] = ()

    @classmethod
    def of_site(cls, site: Site) -> "FixedRoom | None":
        """The fixed room of a site: its key `room`, or the simulated room without people and machine.

        Raises:
            SiteError: a mesh that cannot be read.
        """
        if site.simulated is not None:
            solids = tuple(s for s in InterventionRoom(people=False).at(0.0).static_solids)
            return cls(solids, (), INNER_WALLS_M)
        given = site.entry.room
        if given is None:
            return None
        grid = site.grid()
        return cls.of_entry(given, site.path.parent, np.array([grid.lower_m, grid.upper_m]))

    @classmethod
    def of_entry(
        cls, entry: RoomEntry, beside: Path, box_m: NDArray[np.float64] | None = None
    ) -> "FixedRoom":
        """The room that an entry of a site file describes.

        Args:
            entry: the key `room`.
            beside: the site file's folder.
            box_m: the watched box, shape (2, 3), world frame [m]: what the mesh's size is compared with; None: nothing.

        Raises:
            SiteError: a mesh that cannot be read.
        """
        solids: list[Solid] = []
        surfaces: list[Solid] = []
        walls = None
        if entry.walls is not None:
            walls = np.array([entry.walls.lower_m, entry.walls.upper_m])
            solids += _shell(walls)
        solids += [_static(item.name, join([box(item.lower_m, item.upper_m)])) for item in entry.furniture]
        if entry.mesh in SETUP_NAMES:
            shipped = [_static(solid.name, solid.mesh) for solid in setup(entry.mesh).solids()]
            return cls(tuple(solids + shipped), (), INNER_WALLS_M, (), tuple(shipped))
        room = _read(entry, beside, box_m)
        from_mesh = tuple(_static(one.name, one.mesh, one.is_solid) for one in room.objects)
        for solid in from_mesh:
            (solids if solid.has_inside else surfaces).append(solid)
        if walls is None and room.objects:
            corners = np.concatenate([one.mesh.vertices for one in room.objects])
            walls = np.array([corners.min(axis=0), corners.max(axis=0)])
        notes = room.notes + _open_note(room, entry, box_m)
        return cls(tuple(solids), tuple(surfaces), walls, notes, from_mesh)

    @property
    def moment(self) -> Moment:
        """The room with nothing else in it."""
        return Moment(0.0, self.solids + self.surfaces, {})

    @cached_property
    def triangles(self) -> NDArray[np.float64]:
        """All surfaces, shape (n, 3, 3), world frame [m]."""
        placed = [solid.vertices_in_world[solid.mesh.faces] for solid in self.moment.solids]
        return np.concatenate([np.zeros((0, 3, 3)), *placed])

    def occupied(self, grid: VoxelGrid) -> NDArray[np.bool_]:
        """Voxels that something fixed touches, shape of the grid: they can never be free."""
        occupied = true_occupancy(grid, Moment(0.0, self.solids, {})).occupied.copy()
        for solid in self.surfaces:
            triangles = solid.vertices_in_world[solid.mesh.faces]
            touch_surface(triangles, grid.lower_m, grid.voxel_size_m, SHRINK_M, occupied)
        return occupied

    def refuse_inside(self, cameras: tuple[DepthCamera, ...]) -> None:
        """Refuses cameras that hang inside a solid.

        Raises:
            CameraError: names camera and solid.
        """
        for camera in cameras:
            corner = camera.centre_in_world - SPECK_M / 2
            speck = VoxelGrid((corner[0], corner[1], corner[2]), (1, 1, 1), SPECK_M)
            for solid in self.solids:
                if touched_by(speck, solid)[1].any():
                    raise CameraError(
                        f"camera {camera.name}: at {camera.centre_in_world.round(3).tolist()} m it is inside "
                        f"{solid.name}; move it, or correct the room"
                    )

    def blocking(self, eye_m: NDArray[np.float64], corners_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Triangles that can come between a point and a box.

        A triangle whose plane leaves the point and the whole box on one side cannot.

        Args:
            eye_m: shape (3,) [m].
            corners_m: of the box, shape (8, 3) [m].

        Returns:
            shape (n, 3, 3), world frame [m].
        """
        triangles = self.triangles
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        level = np.einsum("ij,ij->i", normal, triangles[:, 0])
        side = normal @ np.concatenate([corners_m, eye_m[None]]).T - level[:, None]
        return triangles[~((side >= -1e-9).all(axis=1) | (side <= 1e-9).all(axis=1))]


def clear_sight(
    triangles: NDArray[np.float64], eye_m: NDArray[np.float64], points_m: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether nothing lies between a point and others, by exact rays.

    Args:
        triangles: shape (n, 3, 3), world frame [m].
        eye_m: shape (3,), world frame [m].
        points_m: shape (m, 3), world frame [m].

    Returns:
        shape (m,).
    """
    if not len(triangles) or not len(points_m):
        return np.ones(len(points_m), dtype=bool)
    # about the eye: float32 is finest there
    corners = (triangles - eye_m).reshape(-1, 3)
    scene = RayScene(corners, np.arange(len(corners)).reshape(-1, 3))
    rays = (points_m - eye_m).astype(np.float32)
    return ~scene.occluded(np.zeros_like(rays), rays, np.ones(len(rays)))


def _static(name: str, mesh: Mesh, has_inside: bool = True) -> Solid:
    return Solid(name, mesh, np.eye(4), is_static=True, has_inside=has_inside)


def _shell(walls: NDArray[np.float64]) -> list[Solid]:
    """Six slabs about a box."""
    lower, upper = walls
    solids = []
    for axis, names in enumerate((("wall -x", "wall +x"), ("wall -y", "wall +y"), ("floor", "ceiling"))):
        for end, name in enumerate(names):
            low, high = lower - WALL_M, upper + WALL_M
            if end == 0:
                high = np.where(np.arange(3) == axis, lower, high)
            else:
                low = np.where(np.arange(3) == axis, upper, low)
            solids.append(_static(name, join([box(low, high)])))
    return solids


def _read(entry: RoomEntry, beside: Path, box_m: NDArray[np.float64] | None) -> RoomMesh:
    """The room's mesh; without objects if there is none."""
    path = entry.mesh_path(beside)
    if path is None:
        return RoomMesh((), ())
    try:
        return read_room_mesh(path, up=entry.mesh_up, unit_m=entry.mesh_unit_m, box_m=box_m)
    except InputError as error:
        raise SiteError(f"room.mesh: {error}") from None


def _open_note(room: RoomMesh, entry: RoomEntry, box_m: NDArray[np.float64] | None) -> tuple[str, ...]:
    """What is said of objects that block sight and have no inside, and of a mesh that lies somewhere else."""
    notes = []
    through = [one.name for one in room.objects if not one.is_closed]
    if through:
        notes.append(
            f"{entry.mesh}: {listed(through)} not closed: blocks sight, but its inside is asked for as free space is"
        )
    if box_m is not None and room.objects:
        corners = np.concatenate([one.mesh.vertices for one in room.objects])
        if ((corners.max(axis=0) <= box_m[0]) | (corners.min(axis=0) >= box_m[1])).any():
            low, high = (np.round(end, 2).tolist() for end in (corners.min(axis=0), corners.max(axis=0)))
            notes.append(
                f"{entry.mesh}: lies beside the grid, from {low} to {high} m: it hides nothing of it; check its origin"
            )
    return tuple(notes)
