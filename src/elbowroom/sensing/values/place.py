"""Whether a camera can hang where its pose says: far from the grid, or with nothing of it in view."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid, transforms
from elbowroom.sensing.view import in_view

KIND, COPIED = "pose", "same pose"
FARTHEST_M = 100.0
"""No depth camera watches a box that is farther away."""
FAR_M = 15.0
"""From here on it is asked whether the pose has another unit."""
NEAR_M = 3.0
"""A pose that lies so near to the grid in another unit has most likely that unit."""
UNITS = {"millimetres": 0.001, "centimetres": 0.01, "inches": 0.0254}
POINTS = 14
"""Along each side of the grid, to see what is in view."""
TURNS: dict[str, NDArray[np.float64]] = {
    "they are poses of the housing (x forward, z up): with the optical axes instead": np.array(
        [[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    ),
    "their axes are OpenGL's (y up, z back): with OpenCV's axes instead": np.diag([1.0, -1, -1]),
}


def look_at_places(cameras: Sequence[DepthCamera], grid: VoxelGrid) -> list[Finding]:
    """Poses in another unit, or of another frame, by where they put the camera.

    Args:
        cameras: of the room.
        grid: the watched box.
    """
    findings = [found for camera in cameras for found in _distance(camera, grid)] + _copied(cameras)
    away = {name for finding in findings if finding.kind == KIND for name in finding.about}
    points = _points_of(grid)
    blind = [camera for camera in cameras if camera.name not in away and not in_view(camera, points).any()]
    return findings + [_sees_nothing(camera, points, len(blind) == len(cameras)) for camera in blind]


def _copied(cameras: Sequence[DepthCamera]) -> list[Finding]:
    """Cameras that are said to be at one and the same place, to the last digit: a pose that was copied."""
    by_pose: dict[bytes, list[str]] = {}
    for camera in cameras:
        by_pose.setdefault((np.round(camera.world_from_camera, 9) + 0.0).tobytes(), []).append(camera.name)
    return [
        Finding(
            COPIED,
            tuple(names),
            "have one and the same pose, to the last digit, and no two cameras have: was it copied, or are they one?",
            stops=False,
        )
        for names in by_pose.values()
        if len(names) > 1
    ]


def _distance(camera: DepthCamera, grid: VoxelGrid) -> list[Finding]:
    away = distance_m(grid, camera.centre_in_world)
    if away <= min(FAR_M, camera.max_depth_m):
        return []
    unit = unit_of_length(grid, camera.centre_in_world) if away > FAR_M else ""
    where = ", ".join(f"{value:.5g}" for value in camera.centre_in_world)
    text = f"stands at ({where}), {away:.4g} m from the grid"
    if away > camera.max_depth_m:
        text += f", beyond its range of {camera.max_depth_m:g} m"
    if unit:
        text += f": most likely its pose is in {unit}, and must be in metres"
    elif away > FARTHEST_M or away > camera.max_depth_m:
        text += ": check the unit of its pose and of the grid (metres), and the frame that they are in"
    else:
        return []
    return [Finding(KIND, (camera.name,), text, stops=away > FARTHEST_M or bool(unit))]


def unit_of_length(grid: VoxelGrid, place_in_world: NDArray[np.float64]) -> str:
    """The units in which a place would lie at the grid, in words; "": none.

    Args:
        grid: the watched box.
        place_in_world: as it was written, shape (3,).
    """
    near = max(NEAR_M, float(np.linalg.norm(grid.upper_m - grid.lower_m)))
    away = {unit: distance_m(grid, place_in_world * factor) for unit, factor in UNITS.items()}
    fits = [unit for unit, distance in away.items() if distance <= near]
    return " or ".join(sorted(fits, key=lambda unit: -UNITS[unit]))


def distance_m(grid: VoxelGrid, place_in_world: NDArray[np.float64]) -> float:
    """From a place to the nearest point of the grid [m]."""
    off = np.maximum(np.maximum(grid.lower_m - place_in_world, place_in_world - grid.upper_m), 0.0)
    return float(np.linalg.norm(off))


def _points_of(grid: VoxelGrid) -> NDArray[np.float64]:
    steps = np.linspace(0.0, 1.0, POINTS)
    shares = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return grid.lower_m + shares * (grid.upper_m - grid.lower_m)


def _sees_nothing(camera: DepthCamera, points: NDArray[np.float64], are_all: bool) -> Finding:
    """With the frame that its pose is in most likely, if another shows more."""
    pose = camera.world_from_camera
    others = {words: _turned(pose, turn) for words, turn in TURNS.items()}
    others["they are inverses (camera from world): with the inverse instead"] = transforms.invert_rigid(pose)
    share, words = max(
        (float(np.mean(in_view(replace(camera, world_from_camera=other), points))), words)
        for words, other in others.items()
    )
    text = "nothing of the grid is in its view and range"
    if share > 0.02:
        text += f"; most likely {words} {share:.0%} of it would be"
    else:
        text += "; check its pose (world from camera; x right, y down, z forward) and its range"
    return Finding("view", (camera.name,), text, are_all)


def _turned(pose: NDArray[np.float64], housing_from_optical: NDArray[np.float64]) -> NDArray[np.float64]:
    turned = pose.copy()
    turned[:3, :3] = pose[:3, :3] @ housing_from_optical
    return turned
