"""Rows of `elbowroom bench calibration`: intrinsics of simulated cameras against the truth behind their images."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.calibrate import Board, sightings
from elbowroom.calibrate.intrinsics import solve_intrinsics
from elbowroom.calibrate.simulated import BoardCapture, Start, read_truth, record_board, started
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import wall_cameras
from elbowroom.site import Site

BOARD = Board(8, 5, 0.1, "cut_out", 0.04, marked=True, thickness_m=0.003)
START = Start(focal_pct=2.0, lens=True, depth_scale_pct=1.0, depth_bias_m=0.01)


def intrinsics_row(
    kept: Path, cameras: int = 4, poses: int = 80, said: Callable[[str], None] = lambda text: None
) -> dict[str, Any]:
    """Focal lengths found from a board that is cut out, with the noise of a Kinect, against the truth.

    Args:
        kept: folder where the capture is kept, and taken from if it is there.
        cameras: 640 x 480, each with a lens of its own.
        poses: of the board, each right before one camera.
        said: is told what is being done.
    """
    out = kept / f"intrinsics_near_{cameras}x{poses}"
    if not (out / "site.yaml").is_file():
        said(f"rendering {poses} poses for intrinsics")
        hung = wall_cameras(cameras, noise=NOISE_PRESETS["kinect_v1"])
        true_cameras = started(hung, START, np.random.default_rng(5))
        record_board(BoardCapture(true_cameras, BOARD, poses, near=True), out)
    said("looking for the board, solving intrinsics")
    site, truth = Site.load(out / "site.yaml"), read_truth(out)["cameras"]
    begun = time.perf_counter()
    seen = sightings(site)
    off: dict[str, float] = {}
    for camera in site.cameras():
        k = solve_intrinsics(camera, seen.board, seen.views).camera.intrinsics
        true = truth[camera.name]
        off[camera.name] = 100 * max(abs(k.fx / true["fx"] - 1), abs(k.fy / true["fy"] - 1))
    return {
        "kind": "intrinsics",
        "case": f"intrinsics, {cameras} cameras 640x480, {poses} poses near",
        "cameras": cameras,
        "poses": poses,
        "views": len(seen.views),
        "focal_error_pct": off,
        "worst_focal_pct": max(off.values()),
        "due": {"worst_focal_pct": 0.3},
        "seconds": time.perf_counter() - begun,
    }
