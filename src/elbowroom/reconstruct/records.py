"""Cameras in a grid as the records that carving kernels read (`kernels.camera`)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.kernels.bits import plain
from elbowroom.geometry.kernels.noise import DepthMargin, margin_at
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.kernels.camera import CAMERA
from elbowroom.reconstruct.kernels.texels import FAR_CLIP, Counting

Records = NDArray[Any]
"""Shape (cameras,), dtype `kernels.camera.CAMERA`. Each is an `np.record` that may be written through."""

SPARE_M = 0.5
"""Depth beyond the grid's farthest corner that is still told apart."""
LANES = np.stack(np.meshgrid(range(4), range(4), range(4), indexing="ij"), axis=-1).reshape(64, 3)
"""Which of 4 x 4 x 4 boxes is in which lane."""


def records_of(grid: VoxelGrid, cameras: tuple[DepthCamera, ...], margin: Margin) -> Records:
    """A record for each camera, all but where its pixels lie in arrays common to all.

    Args:
        grid: the watched box.
        cameras: pinhole.
        margin: of cameras without one of their own.
    """
    records = np.zeros(len(cameras), dtype=CAMERA)
    for n, camera in enumerate(cameras):
        own, record = camera.margin or margin, records[n]
        _put_pose_and_lens(record, camera)
        _put_margin(record, camera, own, grid)
        _put_rays(record, camera, own)
        _put_boxes(record, camera, grid)
    return records


def margin_of(camera: DepthCamera, margin: Margin) -> DepthMargin:
    """k sigma(z) + bias + range error, as kernels take it."""
    constant, linear, beyond, offset = margin.bias_m, margin.range_linear, 0.0, 0.0
    if camera.noise is not None:
        constant += margin.sigmas * camera.noise.constant_m
        linear += margin.sigmas * camera.noise.linear
        beyond, offset = margin.sigmas * camera.noise.quadratic, camera.noise.offset_m
    # floats, whatever was given: to numba whole numbers are another type, to be compiled anew
    return DepthMargin(*map(float, (constant, linear, margin.range_quadratic, beyond, offset)))


def pitch_of(camera: DepthCamera) -> float:
    """Of a pixel, as a share of its depth."""
    return 1.0 / min(camera.intrinsics.fx, camera.intrinsics.fy)


def counting_of(camera: DepthCamera, record: np.record) -> Counting:
    """How the camera of a record counts depth."""
    margin = DepthMargin(*record["margin"].item())
    return Counting(float(camera.min_depth_m), float(camera.deepest_m), float(record["quantum"]), margin)


def aged(records: Records) -> Records:
    """The same records with boxes grown to all sides by how far anything may have moved since each image."""
    grown = records.copy()
    grown["half_extent"] += records["aged_m"][:, None, None]
    grown["half_diagonal"] += records["aged_m"][:, None]
    return grown


def _put_pose_and_lens(record: np.record, camera: DepthCamera) -> None:
    record["camera_from_world"] = camera.camera_from_world[:3]
    record["centre_in_world"] = camera.centre_in_world
    for name in ("fx", "fy", "cx", "cy"):
        record[name] = getattr(camera.intrinsics, name)
    record["width"], record["height"] = camera.width, camera.height
    record["radial"] = camera.depth_kind == "radial"
    record["flies"] = bool(camera.flying_pixels)


def _put_margin(record: np.record, camera: DepthCamera, margin: Margin, grid: VoxelGrid) -> None:
    """The margin, and a quantum that depths up to the grid's farthest corner can be counted in."""
    of_depth = margin_of(camera, margin)
    corners = grid.lower_m + (grid.upper_m - grid.lower_m) * np.stack(
        np.meshgrid((0, 1), (0, 1), (0, 1), indexing="ij"), axis=-1
    ).reshape(8, 3)
    reach = float(np.linalg.norm(corners - camera.centre_in_world, axis=1).max()) + SPARE_M
    reach += float(plain(margin_at)(of_depth, reach))
    pitch = pitch_of(camera)
    if camera.flying_pixels and pitch < 1.0:
        # the farthest that is told apart, less the pitch that specks are short of it, lies beyond the grid as well
        reach /= 1.0 - pitch
    record["margin"] = of_depth
    record["lateral_px"] = margin.lateral_px
    # a power of two: where a wider margin makes quanta coarser, no rounding becomes more favourable
    record["quantum"] = 2.0 ** np.ceil(np.log2(reach / (FAR_CLIP - 4)))


def _put_rays(record: np.record, camera: DepthCamera, margin: Margin) -> None:
    """How a pixel's direction turns in the world, and the least cosine between a pixel's ray and the optical axis."""
    k, rotation = camera.intrinsics, camera.camera_from_world[:3, :3]
    along_u, along_v = rotation[0] / k.fx, rotation[1] / k.fy
    record["ray"][0] = rotation[2] - along_u * k.cx - along_v * k.cy
    record["ray"][1:3] = along_u, along_v
    record["ray_half_width"] = (np.abs(along_u) + np.abs(along_v)) * (0.5 + margin.lateral_px)
    aside = max(k.cx + 0.5, camera.width - 0.5 - k.cx) / k.fx
    above = max(k.cy + 0.5, camera.height - 0.5 - k.cy) / k.fy
    record["least_cosine"] = 1.0 / np.sqrt(1.0 + aside**2 + above**2)


def _put_boxes(record: np.record, camera: DepthCamera, grid: VoxelGrid) -> None:
    """Voxels and blocks along the camera's axes, and the finest level of windows that is worth its memory."""
    k, rotation = camera.intrinsics, camera.camera_from_world[:3, :3]
    for scale, edge in enumerate((grid.voxel_size_m, 4 * grid.voxel_size_m)):
        shift = rotation @ LANES.T * edge
        record["offset"][scale] = shift * np.array([k.fx, k.fy, 1.0])[:, None]
        record["half_extent"][scale] = np.abs(rotation).sum(axis=1) * edge / 2
        record["half_diagonal"][scale] = edge * 0.8660255
    middle = float(np.linalg.norm(grid.lower_m / 2 + grid.upper_m / 2 - camera.centre_in_world))
    # windows over single pixels only where voxels of the middle of the grid are that small
    record["lowest"] = 0 if 0.5 * grid.voxel_size_m * k.fx < max(middle, 1e-3) else 1
