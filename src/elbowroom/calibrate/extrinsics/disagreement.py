"""What does not go together: a board of another size, a board or a camera that was moved, poses that say too little."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.seen_board import SeenBoard, spread
from elbowroom.calibrate.extrinsics.adjustment import Solution
from elbowroom.errors import CalibrationError

Array = NDArray[np.float64]
SIZE_SHARE = 0.03
"""Distances by corners and by depth may differ by so much: no depth camera's scale is off by more."""
SIZE_SIGMAS = 4.0
MOVED_M = 0.004
MOVED_SIGMAS = 4.0
"""Two views' own poses of the board may lie so far apart."""
MOST_SHIFT_M = 0.002
"""More than this a hand does not shake [m]."""
SAME_PLANE_DEG, SAME_PLANE_M = 3.0, 0.03
LEAST_POSES_FOR_PLANE = 3


def require_board_size(board: Board, seen: Sequence[SeenBoard]) -> None:
    """Distances by the corners' spacing and by depth agree.

    Raises:
        CalibrationError: they differ in all cameras (the board), or in one (its depth scale or its lens).
    """
    ratios: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for one in seen:
        if one.depth_over_corners is not None:
            ratios[one.view.camera].append(one.depth_over_corners)
    if not ratios:
        return
    by_camera = {name: float(np.median([ratio for ratio, _ in own])) for name, own in ratios.items()}
    # of a few small boards in coarse images the distance by corners is not known that well
    sure_to = {name: SIZE_SIGMAS * _median_sigma([sigma for _, sigma in own]) for name, own in ratios.items()}
    overall = float(np.median(list(by_camera.values())))
    worst = max(by_camera, key=lambda name: abs(by_camera[name] / overall - 1) - sure_to[name])
    every = SIZE_SIGMAS * _median_sigma([sigma for own in ratios.values() for _, sigma in own])
    if abs(overall - 1) > SIZE_SHARE + every:
        raise CalibrationError(
            f"board: square_m is {board.square_m:g}, but by the depth images of {_count(len(ratios))} its squares "
            f"are {board.square_m * overall:.4g} m; measure a square, or check depth_scale_m and fx"
        )
    if abs(by_camera[worst] / overall - 1) > SIZE_SHARE + sure_to[worst] and len(by_camera) > 2:
        raise CalibrationError(
            f"camera {worst}: its depth makes the board's squares {board.square_m * by_camera[worst]:.4g} m, "
            f"the others {board.square_m * overall:.4g} m; check its depth_scale_m, depth_kind and fx"
        )


def _median_sigma(sigmas: Sequence[float]) -> float:
    """Of the median of values with these sigmas, about."""
    return 1.2533 * float(np.sqrt(np.mean(np.square(sigmas)) / len(sigmas)))


def require_tilts(seen: Sequence[SeenBoard], solution: Solution) -> None:
    """The board was not always in one and the same plane.

    Raises:
        CalibrationError: three poses or more, all in one plane.
    """
    boards = list(solution.state.boards.values())
    if len(boards) < LEAST_POSES_FOR_PLANE:
        return
    normals = np.array([board[:3, 2] for board in boards])
    normals *= np.sign(normals @ normals[0])[:, None]
    middle = normals.mean(axis=0)
    middle /= np.linalg.norm(middle)
    heights = np.array([board[:3, 3] for board in boards]) @ middle
    tilt = np.degrees(np.arccos(np.clip(normals @ middle, -1, 1))).max()
    if tilt < SAME_PLANE_DEG and np.ptp(heights) < SAME_PLANE_M:
        raise CalibrationError(
            f"all {len(boards)} poses of the board lie in one plane, which leaves the cameras' poses weak; "
            "tilt the board by 20 to 45 degrees, in different directions and at different heights"
        )


def require_still(seen: Sequence[SeenBoard], solution: Solution, corners: Array) -> None:
    """All cameras agree where the board was in each pose.

    Args:
        seen: views.
        solution: of the joint least squares.
        corners: of the board, shape (n, 3), board frame [m].

    Raises:
        CalibrationError: a pose in which the board was moved, or a camera that was.
    """
    by_pose: dict[int, list[SeenBoard]] = defaultdict(list)
    for one in seen:
        by_pose[one.view.pose].append(one)
    off = {(one.view.pose, one.view.camera): 0.0 for one in seen}
    bad: dict[tuple[int, str], float] = {}
    pairs: list[tuple[str, str]] = []
    for pose, views in by_pose.items():
        for number, one in enumerate(views):
            for other in views[number + 1 :]:
                apart, allowed = _apart(one, other, solution, corners)
                if apart > allowed:
                    pairs.append((one.view.camera, other.view.camera))
                    for camera in (one.view.camera, other.view.camera):
                        bad[pose, camera] = max(bad.get((pose, camera), 0.0), apart)
    if not bad:
        return
    poses = sorted({pose for pose, _ in bad})
    off_cameras = sorted({camera for pair in pairs for camera in pair})
    suspect = max(off_cameras, key=lambda camera: sum(camera in pair for pair in pairs))
    bad_of = {camera: sum(camera == other for _, other in bad) for camera in off_cameras}
    views_of = {camera: sum(camera == other for _, other in off) for camera in off_cameras}
    if len(poses) > 2 and sum(suspect in pair for pair in pairs) >= 0.8 * len(pairs):
        raise CalibrationError(
            f"camera {suspect}: disagrees with the others in {bad_of[suspect]} of its {views_of[suspect]} poses "
            f"(by {max(a for (_, c), a in bad.items() if c == suspect) * 1e3:.0f} mm); it was moved between poses, "
            "or its intrinsics are wrong: fix it, calibrate intrinsics, and capture again"
        )
    pose = max(poses, key=lambda p: max(apart for (q, _), apart in bad.items() if q == p))
    apart = max(a for (q, _), a in bad.items() if q == pose)
    cameras = sorted(camera for q, camera in off if q == pose)
    more = f" (and poses {', '.join(str(p) for p in poses if p != pose)})" if len(poses) > 1 else ""
    raise CalibrationError(
        f"pose {pose}{more}: cameras {', '.join(cameras)} do not agree where the board was ({apart * 1e3:.0f} mm); "
        f"it was moved between their images: capture again, or leave pose {pose} out"
    )


def _apart(one: SeenBoard, other: SeenBoard, solution: Solution, corners: Array) -> tuple[float, float]:
    """How far two views' own poses of the board lie apart in the world, and how far they may [m]."""
    box = corners[[0, int(np.argmax(corners[:, 0])), int(np.argmax(corners[:, 1])), len(corners) - 1]]
    reach, variances = float(np.abs(box).max()), solution.variances
    # of all cameras, since what is looked for raises its camera's own
    factor = max(float(np.median(list(variances.corner.values()))), 1.0)
    shake = 6 * min(variances.shift + variances.turn * reach**2, MOST_SHIFT_M**2)
    nearest, allowed = np.inf, 0.0
    for first in one.lone:
        for second in other.lone:
            at, beside = (
                solution.state.cameras[view.view.camera] @ lone.camera_from_board
                for view, lone in ((one, first), (other, second))
            )
            off = np.linalg.norm(
                box @ (at[:3, :3] - beside[:3, :3]).T + at[:3, 3] - beside[:3, 3], axis=1
            ).max()
            if off < nearest:
                square = sum(spread(lone, reach) ** 2 * factor for lone in (first, second)) + shake
                nearest, allowed = float(off), MOVED_M + MOVED_SIGMAS * float(np.sqrt(square))
    return nearest, allowed


def _count(number: int) -> str:
    return "one camera" if number == 1 else f"{number} cameras"


def weak_points(
    name: str, seen: Sequence[SeenBoard], shared: Mapping[str, int], sigma_m: float, sigma_deg: float
) -> tuple[str, ...]:
    """What is weak about a camera's capture and what would mend it, a sentence each.

    Args:
        name: of the camera.
        seen: its views.
        shared: how many poses it has in common with each other camera.
        sigma_m, sigma_deg: how sure its pose is, one sigma [m, degrees].
    """
    camera = seen[0].camera
    notes = []
    if len(seen) < 5:
        notes.append(f"{name}: saw the board in {len(seen)} poses only; show it 5 to 15 times")
    unseen = unseen_parts(camera.width, camera.height, [one.view.corners_px for one in seen])
    if unseen:
        notes.append(f"{name}: no corner ever in the {', '.join(unseen)} of the image; hold the board there")
    tilts = [np.degrees(np.arccos(min(1.0, abs(_facing(one))))) for one in seen]
    if max(tilts) < 20:
        notes.append(
            f"{name}: the board always faced it (tilt up to {max(tilts):.0f} degrees); tilt it by 30 to 45"
        )
    if shared and sum(shared.values()) < 3:
        other = max(shared, key=lambda key: shared[key])
        notes.append(
            f"{name}: hangs on {sum(shared.values())} poses shared with others; show more to it and {other} at once"
        )
    if sigma_m > 0.003 or sigma_deg > 0.1:
        notes.append(
            f"{name}: known to {sigma_m * 1e3:.1f} mm and {sigma_deg:.2f} degrees only; more poses, nearer and tilted"
        )
    return tuple(notes)


def _facing(one: SeenBoard) -> float:
    pose = one.lone[0].camera_from_board
    middle = pose[:3, :3] @ one.corners.mean(axis=0) + pose[:3, 3]
    return float(pose[:3, 2] @ middle / np.linalg.norm(middle))


ROWS, COLUMNS = ("upper", "middle", "lower"), ("left", "middle", "right")


def unseen_parts(width: int, height: int, corners_px: Sequence[Array]) -> list[str]:
    """Which of the image's nine parts never had a corner of the board in them, in words.

    Args:
        width, height: of the image [px].
        corners_px: of each view, shape (n, 2) [px].
    """
    points = np.concatenate([*corners_px, np.zeros((0, 2))])
    column = np.clip((points[:, 0] * 3 / width).astype(int), 0, 2)
    row = np.clip((points[:, 1] * 3 / height).astype(int), 0, 2)
    missing = []
    for r, upper in enumerate(ROWS):
        for c, left in enumerate(COLUMNS):
            if not ((row == r) & (column == c)).any():
                missing.append("middle" if (r, c) == (1, 1) else f"{upper} {left}")
    return missing
