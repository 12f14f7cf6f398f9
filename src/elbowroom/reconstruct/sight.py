"""What one camera saw at one voxel: asked again of its image."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Explained
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.evidence import Evidence
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.point_report import CameraSight, Sight
from elbowroom.reconstruct.terms import Terms


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
    evidence = carve_images(voxel, images, Explained(own, None), terms, complete=True)
    distance_m = float(np.linalg.norm(centre_in_world - camera.centre_in_world))
    in_camera = camera.camera_from_world[:3, :3] @ centre_in_world + camera.camera_from_world[:3, 3]
    place = _place(camera, in_camera, voxel.voxel_size_m)
    image = images.least_m.get(camera.name)
    measured, past = None, False
    if place is not None and image is not None:
        u, v, reach = place
        value = float(image[round(v), round(u)])
        measured = value if np.isfinite(value) and value > 0 else None
        depth_m = distance_m if camera.depth_kind == "radial" else float(in_camera[2])
        rows, columns = (slice(round(at - reach), round(at + reach) + 1) for at in (v, u))
        past = bool((image[rows, columns] > depth_m + voxel.voxel_size_m).any())
    return CameraSight(camera.name, _sight(evidence, place is not None, past), distance_m, measured)


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
