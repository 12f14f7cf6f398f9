"""Where the scale model's free travel is lost: millimetres for each cause, over the ways in view, by size of voxel.

    python benchmarks/scale_budget.py

Writes benchmarks/results/scale_budget.json, which docs/evaluation.md shows; takes some five minutes. The last row is of
poses for which the cameras were not placed. Each column adds one cause to those before it, and says how far free travel
ends before the truth, median and worst: *voxels* are those that the true objects touch, in an else open space; *view*
ends where the first voxel is that no camera sees all of, by exact rays; *pixels* are exact images, *margin* the same
with three sigmas of a Kinect allowed for, *noise* images with that noise.
"""

import itertools
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from elbowroom.evaluate.rooms.scene import WELL_KNOWN
from elbowroom.evaluate.thesis.scale import EXPLAIN_M, near_m, noisy_frames
from elbowroom.evaluate.thesis.scale_model import (
    POSES,
    VOXEL_M,
    VOXEL_SIZES_M,
    body_growth,
    kinects,
    model_grid,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.thesis.way_view import WayView
from elbowroom.files.json_rows import meta
from elbowroom.geometry import bits
from elbowroom.machine import body_words
from elbowroom.motion import blocks_in_reach, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.simulate import Moment, true_occupancy
from elbowroom.simulate.machine_solids import link_solids

RESULT = Path(__file__).resolve().parent / "results" / "scale_budget.json"
ROWS = tuple((edge, range(POSES)) for edge in VOXEL_SIZES_M) + ((VOXEL_M, range(POSES, 2 * POSES)),)
"""Edge of the voxels [m], and poses."""
CAUSES = ("voxels", "view", "pixels", "margin", "noise")


def shortfalls(pose: int, voxel_size_m: float) -> list[list[float]]:
    """For each motion of a pose, how much its travel ends before the truth by each of `CAUSES` [mm]."""
    machine, grid = model_machine(), model_grid(voxel_size_m)
    joints, met = model_pose(pose)
    motions = list(met)
    moment = Moment(1.0, model_solids() + link_solids(machine, joints), joints)
    occupied = true_occupancy(grid, moment).occupied
    body = bits.unpack(body_words(machine, joints, grid, body_growth(voxel_size_m)), grid)
    spaces = [FreeSpace.from_occupied(grid, occupied & ~body)]
    focus = blocks_in_reach(grid, machine, joints, motions)
    for allowed, noise in ((False, False), (True, False), (True, True)):
        frames = noisy_frames(kinects(noise), moment, pose)
        spaces.append(
            reconstruct(
                grid,
                kinects(allowed),
                frames,
                machine=machine,
                joints=joints,
                margin=WELL_KNOWN,
                explain_tolerance_m=EXPLAIN_M,
                body_growth_m=body_growth(voxel_size_m),
                focus=focus,
            )
        )
    travels = [[v.free_travel for v in check_motions(space, machine, joints, motions)] for space in spaces]
    view = WayView(machine, moment, grid, body_growth(voxel_size_m))
    seen = [
        view.travel_in_view(view.way(motion, contact.travel), kinects(False), contact.travel)
        for motion, contact in met.items()
    ]
    rows = zip(met.values(), travels[0], seen, *travels[1:], strict=True)
    return [[1000 * (c.travel - travel) * c.speed for travel in row] for c, *row in rows]


def main() -> None:
    """A row for each size of voxel, written as soon as it is there."""
    said, done = meta() | {"command": "python benchmarks/scale_budget.py"}, []
    for edge, poses in ROWS:
        with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
            found = pool.map(shortfalls, poses, itertools.repeat(edge))
            rows = np.array([row for of_pose in found for row in of_pose])
        mine = rows[rows[:, CAUSES.index("view")] <= 1000 * near_m(edge)]
        if not len(mine):
            raise SystemExit(f"voxels of {1000 * edge:g} mm, poses from {poses.start}: no way is in view")
        pairs = [[round(float(np.median(column)), 2), round(float(column.max()), 2)] for column in mine.T]
        short_mm = dict(zip(CAUSES, pairs, strict=True))
        judged = poses.start == 0
        counts = {"voxel_size_m": edge, "judged": judged, "motions": len(rows), "in_view": len(mine)}
        done.append(counts | {"short_mm": short_mm})
        print(json.dumps(done[-1]), file=sys.stderr)
        RESULT.write_text(json.dumps({"meta": said, "rows": done}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
