"""Which share of the space that motions sweep no camera sees, by link, and why."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.sight import BACKGROUND_PX
from elbowroom.placement.swept.swept import coarse_grid, swept_by_link
from elbowroom.sensing.view import in_view
from elbowroom.simulate import Moment, render
from elbowroom.simulate.machine_solids import link_solids

LITRES = 1e3
EDGE_IN_VOXELS = 1.0
"""Images that end so much below what is swept, or more, are said to."""


@dataclass(frozen=True, slots=True, eq=False)
class LinkSwept:
    """What one link sweeps, in all poses together.

    Args:
        link: its name.
        voxels: how many; a voxel counts once a pose.
        no_image: of these, such that lie in no camera's image and range.
        hidden: of these, such that lie in an image, with the machine or the room in between.
    """

    link: str
    voxels: int
    no_image: int
    hidden: int

    @property
    def unseen_pct(self) -> float:
        """Share that no camera sees [%]."""
        return 100.0 * (self.no_image + self.hidden) / max(self.voxels, 1)


@dataclass(frozen=True, slots=True, eq=False)
class Swept:
    """What the motions of a machine sweep, and what of it no camera sees.

    Args:
        grid: the voxels that it is told of.
        poses: how many poses the machine was looked at in.
        links: each link that sweeps anything, the one of which least is seen first.
        swept: in how many poses each voxel is swept, shape of the grid.
        unseen: in how many of these no camera sees it, shape of the grid.
        imaged: whether a voxel is swept and in some camera's image and range, shape of the grid.
        by_pose: of each pose its joints and the swept voxels that nobody sees, shape of the grid.
    """

    grid: VoxelGrid
    poses: int
    links: tuple[LinkSwept, ...]
    swept: NDArray[np.int64]
    unseen: NDArray[np.int64]
    imaged: NDArray[np.bool_]
    by_pose: tuple[tuple[Mapping[str, float], NDArray[np.bool_]], ...] = field(default=())

    @property
    def unseen_pct(self) -> float:
        """Share of all that is swept that no camera sees [%]."""
        return 100.0 * float(self.unseen.sum()) / max(float(self.swept.sum()), 1.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where all images end before what the machine sweeps does: at the top, and at the bottom."""
        found = []
        swept, imaged = self._layers(self.swept > 0), self._layers(self.imaged)
        if not len(swept):
            return ()
        edge, floor = self.grid.voxel_size_m, float(self.grid.lower_m[2])
        if not len(imaged):
            return ("no camera has anything in its image that the machine sweeps",)
        top, seen_top = floor + edge * (swept[-1] + 1), floor + edge * (imaged[-1] + 1)
        if swept[-1] - imaged[-1] >= EDGE_IN_VOXELS:
            found.append(
                f"the upper edge of all images lies at z {seen_top:.2f} m about the machine, and it sweeps up to "
                f"{top:.2f} m: nobody sees what is above; aim some cameras higher, or hang them lower"
            )
        if imaged[0] - swept[0] >= EDGE_IN_VOXELS:
            found.append(
                f"the lower edge of all images lies at z {floor + edge * imaged[0]:.2f} m about the machine, and it "
                f"sweeps down to {floor + edge * swept[0]:.2f} m: nobody sees what is below; aim some cameras lower"
            )
        return tuple(found)

    def _layers(self, voxels: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Indices of the layers along z that hold any of some voxels."""
        return np.flatnonzero(voxels.any(axis=(0, 1)))

    def row(self) -> dict[str, Any]:
        """As a row of results has it: litres, shares [%]."""
        litres = LITRES * self.grid.voxel_size_m**3 / max(self.poses, 1)
        return {
            "swept_poses": self.poses,
            "swept_voxel_size_m": self.grid.voxel_size_m,
            "swept_unseen_pct": self.unseen_pct,
            "swept_links": [
                {
                    "link": link.link,
                    "litres": litres * link.voxels,
                    "unseen_pct": link.unseen_pct,
                    "no_image_pct": 100.0 * link.no_image / max(link.voxels, 1),
                    "hidden_pct": 100.0 * link.hidden / max(link.voxels, 1),
                }
                for link in self.links
            ],
            "swept_warnings": list(self.warnings),
        }


def swept_of(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    machine: Machine,
    motions: Sequence[Motion],
    poses: Sequence[Mapping[str, float]],
    room: FixedRoom | None = None,
) -> Swept:
    """What the motions from some poses sweep, and what of it no camera sees: the machine itself hides, and the room.

    A voxel is seen if its centre falls on a pixel of some camera, before the machine and the room, within its range.
    Voxels that the room touches are no part of it, nor those of the machine where it stands.

    Args:
        grid: the watched box; it is told of no more than `MOST_VOXELS` voxels.
        cameras: of the room.
        machine: what moves.
        motions: each as far as it is looked at.
        poses: at least one.
        room: walls and furniture; None: not known, then every pixel has a return.

    Raises:
        MachineError: joints that are not possible.
        CameraError: a camera inside a solid of the room.
    """
    coarse = coarse_grid(grid)
    if room is not None:
        room.refuse_inside(tuple(cameras))
    taken = np.zeros(coarse.shape, dtype=bool) if room is None else room.occupied(coarse)
    by_link = [_without(swept_by_link(coarse, machine, joints, motions), taken) for joints in poses]
    of_all = [np.logical_or.reduce([taken & ~taken, *links.values()]) for links in by_link]
    swept = _summed(of_all)
    images = _imaged(coarse, cameras, np.asarray(swept > 0))
    counts: dict[str, NDArray[np.int64]] = {}
    by_pose = []
    for joints, links, voxels in zip(poses, by_link, of_all, strict=True):
        unseen = voxels.copy()
        points = coarse.centre_of(np.argwhere(voxels))
        unseen[voxels] = ~seen_at(points, cameras, scene_at(machine, joints, room), room is not None)
        for name, own in links.items():
            parts = (own, own & ~images, own & images & unseen)
            own_counts = np.array([int(part.sum()) for part in parts], dtype=np.int64)
            counts[name] = counts.get(name, np.zeros(3, dtype=np.int64)) + own_counts
        by_pose.append((joints, unseen))
    links_swept = [LinkSwept(name, *(int(n) for n in count)) for name, count in counts.items() if count[0]]
    links_swept.sort(key=lambda link: -link.unseen_pct)
    nowhere = _summed([unseen for _, unseen in by_pose])
    return Swept(coarse, len(poses), tuple(links_swept), swept, nowhere, images, tuple(by_pose))


def _summed(masks: Sequence[NDArray[np.bool_]]) -> NDArray[np.int64]:
    """In how many of some masks each voxel is."""
    return np.asarray(np.sum(masks, axis=0, dtype=np.int64))


def _without(
    by_link: Mapping[str, NDArray[np.bool_]], taken: NDArray[np.bool_]
) -> dict[str, NDArray[np.bool_]]:
    return {name: voxels & ~taken for name, voxels in by_link.items()}


def _imaged(grid: VoxelGrid, cameras: Sequence[DepthCamera], voxels: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Of some voxels those that lie in some camera's image and range, shape of the grid."""
    points, imaged = grid.centre_of(np.argwhere(voxels)), voxels.copy()
    found = np.zeros(len(points), dtype=np.bool_)
    for camera in cameras:
        left = np.flatnonzero(~found)
        found[left] = in_view(camera, points[left])
    imaged[voxels] = found
    return imaged


def seen_at(
    points_in_world: NDArray[np.float64],
    cameras: Sequence[DepthCamera],
    moment: Moment,
    closed: bool,
) -> NDArray[np.bool_]:
    """Which points some camera sees, with what is there in between, shape (n,).

    Args:
        points_in_world: shape (n, 3) [m].
        cameras: that look.
        moment: what stands in between.
        closed: whether what lies behind the points is known too; else every pixel is taken to have a return.
    """
    seen = np.zeros(len(points_in_world), dtype=np.bool_)
    plain = [_plain(camera, endless=not closed) for camera in cameras]
    for camera, pinhole, frame in zip(cameras, plain, render(plain, moment, noise=False), strict=True):
        left = np.flatnonzero(~seen)
        left = left[in_view(camera, points_in_world[left])]
        depth_m = np.asarray(frame.depth_m)
        if not closed:
            depth_m = np.where(depth_m > 0, depth_m, np.float32(np.inf))
        k = pinhole.intrinsics
        x, y, z = ((points_in_world[left] - camera.centre_in_world) @ camera.world_from_camera[:3, :3]).T
        column = np.clip(np.rint(k.fx * x / z + k.cx), 0, pinhole.width - 1).astype(np.intp)
        row = np.clip(np.rint(k.fy * y / z + k.cy), 0, pinhole.height - 1).astype(np.intp)
        seen[left] = z < depth_m[row, column]
    return seen


def scene_at(machine: Machine, joints: Mapping[str, float], room: FixedRoom | None) -> Moment:
    """The machine where it stands, and the room about it.

    Args:
        machine, joints: which, and where.
        room: None: not known.
    """
    links = link_solids(machine, joints)
    return Moment(0.0, links if room is None else (*room.moment.solids, *links), dict(joints))


def _plain(camera: DepthCamera, endless: bool) -> DepthCamera:
    """The camera with few pixels, no lens and planar depth: enough to know what stands before what."""
    coarse = with_joined_pixels(camera, BACKGROUND_PX)
    return replace(
        coarse,
        intrinsics=replace(coarse.intrinsics, distortion=()),
        depth_kind="planar",
        noise=None,
        mask=None,
        min_depth_m=0.0,
        max_depth_m=math.inf if endless else coarse.max_depth_m,
    )
