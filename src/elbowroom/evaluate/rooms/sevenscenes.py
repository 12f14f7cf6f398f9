"""False-free rate on real images: carve with some views, check with the surfaces that the others measured."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.evaluate.due import Due, where
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct import DETAILS, RULES, FreeSpace, Terms, resolve
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.explained import NOTHING
from elbowroom.reconstruct.images import room_images
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.site import Site
from elbowroom.sources import excluded_frames, moments

NARROW = Margin(sigmas=0.0, bias_m=0.005, lateral_px=0.0, range_quadratic=0.002)
"""The narrower margin of the comparison, without flying-pixel filter: what is found when less is held back."""
DUE = (
    Due("false_pct", "≤", 0.30, where(voxel_size_m=0.05), "false"),
    Due("free_pct", "≥", 10.0, where(voxel_size_m=0.05, rule="three"), "free by three"),
    Due("free_pct", "≥", 10.0, where(voxel_size_m=0.05, rule="majority"), "by majority"),
    Due("free_pct", "≥", 16.0, where(voxel_size_m=0.05, rule="veto"), "by veto"),
    Due("free_pct", "≥", 20.0, where(voxel_size_m=0.05, rule="any"), "by any"),
)
"""Of at least one detail and margin of a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class CheckViews:
    """A recording split into views that carve and points that check.

    Args:
        grid: of the site, maybe with another voxel size.
        cameras, frames: those that carve.
        points_in_world: (n, 3), measured by the views that were left out, inside the grid [m].
        margin: of the site.
    """

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    frames: tuple[DepthFrame, ...]
    points_in_world: NDArray[np.float64]
    margin: Margin


def split_recording(site: Site, voxel_size_m: float) -> CheckViews:
    """Reads a site of the layout `seven_scenes` whose `exclude` names the views that check.

    Raises:
        SiteError: no views were left out, or what reading the site raises.
    """
    grid = site.grid()
    grid = VoxelGrid.covering(grid.lower_m, grid.upper_m, voxel_size_m)
    moment = next(iter(moments(site)))
    points = [
        camera.points_in_world(frame.depth_m)[_valid(camera, frame)]
        for camera, frame in excluded_frames(site)
    ]
    if not points:
        raise SiteError(f"{site.path}: recording.exclude is empty, some views must be left out to check with")
    surface = np.concatenate(points)
    return CheckViews(
        grid, tuple(site.cameras()), tuple(moment.frames), surface[grid.contains(surface)], site.margin()
    )


def _valid(camera: DepthCamera, frame: DepthFrame) -> NDArray[np.bool_]:
    depth = frame.depth_m
    return (depth > 0) & (depth >= camera.min_depth_m) & (depth <= camera.deepest_m) & np.isfinite(depth)


def rates(views: CheckViews, space: FreeSpace) -> tuple[float, float]:
    """Share of all voxels that is free, and share of the check points that lie in a free voxel [%]."""
    index = views.grid.index_of(views.points_in_world)
    free = space.free
    return 100 * float(free.mean()), 100 * float(free[index[:, 0], index[:, 1], index[:, 2]].mean())


def sevenscenes_rows(path: Path, voxel_sizes_m: tuple[float, ...]) -> Iterator[dict[str, object]]:
    """Every rule and detail, with the site's margin and with a narrow one.

    Yields:
        Rows of voxel_size_m, rule, detail, margin, margin_bias_m, margin_range_quadratic, lateral_px, flying_pixels,
        free_pct, false_pct, points.
    """
    site = Site.load(path)
    angle_deg = site.terms().witness_angle_deg
    for voxel_size_m in voxel_sizes_m:
        views = split_recording(site, voxel_size_m)
        plain = tuple(replace(camera, flying_pixels=False) for camera in views.cameras)
        for name, cameras, margin in (("site", views.cameras, views.margin), ("narrow", plain, NARROW)):
            for detail in DETAILS:
                terms = Terms(detail=detail, margin=margin, witness_angle_deg=angle_deg)
                images = room_images(cameras, views.frames)
                evidence = carve_images(views.grid, images, NOTHING, terms, complete=True)
                for rule in RULES:
                    space = resolve(evidence, cameras, rule=rule, detail=detail, margin=margin)
                    free_pct, false_pct = rates(views, space)
                    yield {
                        "voxel_size_m": voxel_size_m,
                        "rule": rule,
                        "detail": detail,
                        "margin": name,
                        "margin_bias_m": margin.bias_m,
                        "margin_range_quadratic": margin.range_quadratic,
                        "lateral_px": margin.lateral_px,
                        "flying_pixels": bool(cameras[0].flying_pixels),
                        "free_pct": free_pct,
                        "false_pct": false_pct,
                        "points": len(views.points_in_world),
                    }
