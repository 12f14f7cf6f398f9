"""What one camera saw at one voxel: asked again of its image."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.kernels.bits import plain
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.machine import Explained
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.evidence import Evidence
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.point_report import CameraSight, Sight
from elbowroom.reconstruct.records import margin_of
from elbowroom.reconstruct.terms import Terms

NEXT_TO_NOTHING_M = 1e-3
"""A model's depth that is nearer to zero than this says that the machine does not explain the pixel [m]."""


def sight_of(
    voxel: VoxelGrid,
    centre_in_world: NDArray[np.float64],
    images: RoomImages,
    model_depth: Mapping[str, Image],
    terms: Terms,
) -> CameraSight:
    """What a camera saw at a voxel.

    Args:
        voxel: a grid of it alone.
        centre_in_world: its centre, shape (3,) [m].
        images: of one camera.
        model_depth: by camera, what the machine explains [m].
        terms: by which space was judged.
    """
    (camera,) = images.cameras
    own = {name: model for name, model in model_depth.items() if name == camera.name}
    model, now = Explained(own, None), replace(images, aged_m={})
    evidence = carve_images(voxel, now, model, terms, complete=True)
    # age takes away what was seen through, and nothing else
    is_aged = bool(evidence.through[0].any()) and bool(images.aged_m.get(camera.name))
    if is_aged:
        is_aged = not carve_images(voxel, images, model, terms, complete=True).through[0].any()
    distance_m = float(np.linalg.norm(centre_in_world - camera.centre_in_world))
    in_camera = camera.camera_from_world[:3, :3] @ centre_in_world + camera.camera_from_world[:3, 3]
    place = _place(camera, in_camera, voxel.voxel_size_m)
    image = images.least_m.get(camera.name)
    if place is None or image is None:
        return CameraSight(camera.name, _sight(evidence, place is not None, False), distance_m, None)
    u, v, reach = place
    value = float(image[round(v), round(u)])
    depth_m = distance_m if camera.depth_kind == "radial" else float(in_camera[2])
    window = tuple(slice(round(at - reach), round(at + reach) + 1) for at in (v, u))
    past = bool((image[window] > depth_m + voxel.voxel_size_m).any())
    foreign, valid = not_the_machine(camera, image, model_depth, window)
    near, far = _reach(camera, depth_m, voxel.voxel_size_m)
    return CameraSight(
        camera.name,
        Sight.AGED if is_aged else _sight(evidence, True, past),
        distance_m,
        value if np.isfinite(value) and value > 0 else None,
        (near, far),
        float(image[window][foreign].min()) if foreign.any() else None,
        margin_m=float(plain(margin_at)(margin_of(camera, camera.margin or terms.margin), far)),
        sigma_m=0.0 if camera.noise is None else float(camera.noise.sigma(far)),
        without_return=1.0 - float(valid.mean()),
    )


def surface_about(
    voxel: VoxelGrid,
    centre_in_world: NDArray[np.float64],
    images: RoomImages,
    model_depth: Mapping[str, Image],
) -> NDArray[np.float64]:
    """What a camera measured about a voxel, the machine's own apart, shape (n, 3), world frame [m].

    Args:
        voxel: a grid of it alone.
        centre_in_world: its centre, shape (3,) [m].
        images: of one camera.
        model_depth: by camera, what the machine explains [m].
    """
    (camera,) = images.cameras
    in_camera = camera.camera_from_world[:3, :3] @ centre_in_world + camera.camera_from_world[:3, 3]
    place, image = _place(camera, in_camera, voxel.voxel_size_m), images.least_m.get(camera.name)
    if place is None or image is None:
        return np.zeros((0, 3))
    u, v, reach = place
    window = tuple(slice(round(at - reach), round(at + reach) + 1) for at in (v, u))
    foreign, _ = not_the_machine(camera, image, model_depth, window)
    rows, columns = np.nonzero(foreign)
    rows, columns = rows + window[0].start, columns + window[1].start
    k = camera.intrinsics
    rays = np.stack([(columns - k.cx) / k.fx, (rows - k.cy) / k.fy, np.ones(len(rows))], axis=1)
    depth = image[rows, columns].astype(np.float64)
    if camera.depth_kind == "radial":
        depth /= np.linalg.norm(rays, axis=1)
    return rays * depth[:, None] @ camera.world_from_camera[:3, :3].T + camera.centre_in_world


def not_the_machine(
    camera: DepthCamera, image: Image, model_depth: Mapping[str, Image], window: tuple[slice, ...]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Of the pixels of a window, which have a valid return that the machine does not explain, and which a valid one.

    Args:
        camera: of the image.
        image: its depth, shape (height, width) [m].
        model_depth: by camera, what the machine explains, as `Explained.model_depth` [m].
        window: rows and columns.
    """
    depth = image[window]
    with np.errstate(invalid="ignore"):
        valid = (
            np.isfinite(depth) & (depth > 0) & (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m)
        )
    model = model_depth.get(camera.name)
    if model is None:
        return valid, valid
    # next to nothing below zero: the machine is about the pixel, and does not explain it
    return valid & (np.abs(model[window]) < NEXT_TO_NOTHING_M), valid


def _reach(camera: DepthCamera, depth_m: float, edge_m: float) -> tuple[float, float]:
    """Depth of the nearest and the farthest point of a voxel whose centre lies at a depth [m]."""
    if camera.depth_kind == "radial":
        half = edge_m * 3**0.5 / 2
    else:
        half = edge_m / 2 * float(np.abs(camera.camera_from_world[2, :3]).sum())
    return depth_m - half, depth_m + half


def _place(
    camera: DepthCamera, in_camera: NDArray[np.float64], edge_m: float
) -> tuple[float, float, float] | None:
    """Column and row of a voxel's centre, how far about them it reaches [px]; None: it is not all in the image,
    or its centre is masked.
    """
    if not in_camera[2] > 0:
        return None
    k = camera.intrinsics
    # a voxel that spills over the edge of the image can never be seen through
    reach = edge_m * 0.87 * max(k.fx, k.fy) / in_camera[2]
    u, v = k.fx * in_camera[0] / in_camera[2] + k.cx, k.fy * in_camera[1] / in_camera[2] + k.cy
    half = reach + 2
    if camera.mask is not None and _is_masked(camera.mask, u, v):
        return None
    visible = half <= u <= camera.width - 1 - half and half <= v <= camera.height - 1 - half
    return (u, v, reach) if visible else None


def _is_masked(mask: NDArray[np.bool_], u: float, v: float) -> bool:
    """Whether the pixel at a place says nothing."""
    row, column = round(v), round(u)
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])


def _sight(evidence: Evidence, visible: bool, past: bool) -> Sight:
    """One camera's say of one voxel in words.

    Args:
        evidence: of the camera and the voxel.
        visible: all of the voxel is in the image.
        past: a pixel about it measured something behind it.
    """
    if evidence.through[0].any():
        return Sight.THROUGH
    if evidence.surface.any():
        return Sight.SURFACE
    if evidence.blind.any():
        return Sight.BLIND
    if evidence.disputed.any() or past:
        return Sight.EDGE
    return Sight.HIDDEN if visible else Sight.OUTSIDE
