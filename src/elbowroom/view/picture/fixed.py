"""What stands in a room as layers: walls cut away where they would hide it, people, the machine, measured surfaces."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.rays import pixel_rays
from elbowroom.simulate.solid import Solid
from elbowroom.view.picture.layer import Layer
from elbowroom.view.picture.viewpoint import Viewpoint

Array = NDArray[np.float64]
ROOM, PEOPLE, MACHINE = (0.80, 0.79, 0.76), (0.42, 0.56, 0.55), (0.62, 0.70, 0.84)
"""Of things without a colour of their own, linear."""
WALL_DEPTH_M = 0.35
"""So far from the end of a room its walls may reach inwards [m]."""
WALL_SHARE = 0.4
"""What spans so much of a side of a room, both ways, may be that side's wall."""
MEASURED_PX = 120
"""Of measured surfaces every so many-th part of an image's width is drawn."""
JUMP = 0.06
"""Neighbouring returns farther apart in depth than this share of it are no surface."""
MEASURED = (0.66, 0.66, 0.64)


def room_layer(solids: Sequence[Solid], walls_m: Array | None, view: Viewpoint) -> Layer:
    """What never moves, without the walls between it and somebody who looks from outside.

    Args:
        solids: of the room.
        walls_m: least and greatest corner of the room, shape (2, 3), world frame [m]; None: nothing is cut away.
        view: from where.
    """
    triangles, colours, things = [np.zeros((0, 3, 3))], [np.zeros((0, 3))], [np.zeros(0, np.int32)]
    for number, solid in enumerate(solids):
        part = solid.vertices_in_world[solid.mesh.faces]
        if walls_m is not None:
            part = part[~_in_the_way(part, walls_m, view)]
        triangles.append(part)
        colours.append(np.tile(np.array(solid.colour or ROOM), (len(part), 1)))
        things.append(np.full(len(part), number, np.int32))
    return Layer(np.concatenate(triangles), np.concatenate(colours), np.concatenate(things))


def _in_the_way(triangles: Array, walls_m: Array, view: Viewpoint) -> NDArray[np.bool_]:
    """Triangles of one thing that belong to a wall which the view comes through, shape (n,)."""
    hidden = np.zeros(len(triangles), dtype=bool)
    if not len(triangles):
        return hidden
    least, most = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    spans = (most - least) >= WALL_SHARE * (walls_m[1] - walls_m[0])
    ahead = view.world_from_view[:3, 2]
    for axis in range(3):
        if not np.delete(spans, axis).all():
            continue
        if _comes_from(view, ahead, axis, -1, walls_m):
            hidden |= (triangles[:, :, axis] <= walls_m[0, axis] + WALL_DEPTH_M).all(axis=1)
        if _comes_from(view, ahead, axis, 1, walls_m):
            hidden |= (triangles[:, :, axis] >= walls_m[1, axis] - WALL_DEPTH_M).all(axis=1)
    return hidden


def _comes_from(view: Viewpoint, ahead: Array, axis: int, side: int, walls_m: Array) -> bool:
    """Whether somebody looks in from beyond a side of the room."""
    if view.is_parallel:
        return bool(ahead[axis] * side < -0.1)
    beyond = view.eye_m[axis] - walls_m[(side + 1) // 2, axis]
    return bool(beyond * side > 0)


def people_layer(solids: Sequence[Solid]) -> Layer:
    """People and whatever else moves that is not the machine.

    Args:
        solids: of a moment; those of the machine and those that never move are left out.
    """
    kept = [solid for solid in solids if not solid.is_machine and not solid.is_static]
    parts = [solid.vertices_in_world[solid.mesh.faces] for solid in kept]
    # a person's hair is a solid of its own, and no thing of its own
    names = sorted({solid.name.removesuffix(" hair") for solid in kept})
    things = [names.index(solid.name.removesuffix(" hair")) for solid in kept]
    counts = [len(part) for part in parts]
    colours = [np.array(solid.colour or PEOPLE) * (0.45 if solid.is_dark else 1.0) for solid in kept]
    return Layer(
        np.concatenate([np.zeros((0, 3, 3)), *parts]),
        np.repeat(np.array(colours).reshape(-1, 3), counts, axis=0),
        np.repeat(np.array(things, np.int32), counts),
    )


def machine_layer(machine: Machine, joints: Mapping[str, float]) -> Layer:
    """The machine as cameras see it.

    Args:
        machine: any.
        joints: positions by name [m or rad].
    """
    seen = machine.as_seen
    placed = seen.world_from_links(joints)
    links = [link for link in seen.links if link.has_geometry]
    parts = [link.triangles @ placed[link.name][:3, :3].T + placed[link.name][:3, 3] for link in links]
    things = np.repeat(np.arange(len(parts), dtype=np.int32), [len(part) for part in parts])
    triangles = np.concatenate([np.zeros((0, 3, 3)), *parts])
    return Layer(triangles, np.tile(np.array(MACHINE), (len(triangles), 1)), things)


def measured_layer(cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame]) -> Layer:
    """Surfaces that cameras measured: neighbouring pixels of about one depth as triangles.

    Args:
        cameras: of the frames.
        frames: at most one of each camera.
    """
    known = {camera.name: camera for camera in cameras}
    parts = [np.zeros((0, 3, 3))]
    for frame in frames:
        camera = known.get(frame.camera)
        if camera is not None:
            parts.append(_surface(camera, np.asarray(frame.depth_m, dtype=np.float64)))
    triangles = np.concatenate(parts)
    # no lines between what several cameras saw of one thing
    return Layer(
        triangles, np.tile(np.array(MEASURED), (len(triangles), 1)), np.zeros(len(triangles), np.int32)
    )


def _surface(camera: DepthCamera, depth_m: Array) -> Array:
    """Triangles of one image, shape (n, 3, 3), world frame [m]."""
    step = max(1, camera.width // MEASURED_PX)
    rays = pixel_rays(camera)
    x, y = (np.asarray(side, dtype=np.float64)[::step, ::step] for side in (rays.x, rays.y))
    depth = depth_m[::step, ::step]
    planar = depth / np.sqrt(1 + x**2 + y**2) if camera.depth_kind == "radial" else depth
    points = np.stack([x * planar, y * planar, planar], axis=-1)
    valid = np.isfinite(depth) & (depth > camera.min_depth_m) & (depth <= camera.max_depth_m)
    corners = [(slice(None, -1), slice(None, -1)), (slice(1, None), slice(None, -1))]
    corners += [(slice(1, None), slice(1, None)), (slice(None, -1), slice(1, None))]
    depths = np.stack([depth[c] for c in corners])
    whole = np.logical_and.reduce([valid[c] for c in corners])
    with np.errstate(invalid="ignore"):
        whole &= np.ptp(depths, axis=0) < JUMP * depths.min(axis=0)
    quads = np.stack([points[c][whole] for c in corners], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    pose = camera.world_from_camera
    return np.asarray(triangles @ pose[:3, :3].T + pose[:3, 3])
