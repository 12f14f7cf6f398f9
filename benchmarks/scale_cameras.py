"""Where the scale model's four Kinects stand: from where exact rays reach most of the motions' ways.

    python benchmarks/scale_cameras.py

Candidates stand on rings about the middle of the C. For each motion that the evaluation judges, every voxel of its way
is asked of every candidate: is all of it in view? Then four are chosen, one exchanged at a time, that have the most
ways wholly in view up to two voxels before the contact. No image and no verdict plays a part.
"""

import itertools

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.scale import NEAR_VOXELS
from elbowroom.evaluate.scale_model import (
    AIM_M,
    LABORATORY,
    POSES,
    VOXEL_M,
    kinect,
    model_grid,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.way_view import WayView
from elbowroom.simulate import Moment
from elbowroom.simulate.machine_solids import link_solids

DISTANCES_M, AZIMUTHS_DEG, HEIGHTS_M = (0.8, 0.9), range(0, 360, 20), (0.03, 0.12, 0.25, 0.45, 0.7, 0.9)
CLEAR_M = 0.55
"""Nothing is nearer to a Kinect than this, which measures from 0.5 m on [m]."""
STARTS = 10
NEARLY = 0.997
"""From this share of its voxels on a way counts a little, so that the search has a slope to climb."""


def candidates() -> NDArray[np.float64]:
    """Places on rings, shape (n, 3) [m]."""
    places = []
    for distance, azimuth, height in itertools.product(DISTANCES_M, np.radians(AZIMUTHS_DEG), HEIGHTS_M):
        across_squared = distance**2 - (height - AIM_M[2]) ** 2
        if across_squared > 0.1:
            across = np.sqrt(across_squared)
            places.append((across * np.cos(azimuth), across * np.sin(azimuth), height))
    near = np.concatenate([s.vertices_in_world for s in model_solids() if s.name not in LABORATORY])
    links = [link_solids(model_machine(), model_pose(pose)[0]) for pose in range(POSES)]
    near = np.concatenate([near, *(s.vertices_in_world for solids in links for s in solids)])
    clear = [np.linalg.norm(near - place, axis=1).min() > CLEAR_M for place in places]
    return np.array(places)[clear]


def views_of_ways(places: NDArray[np.float64]) -> list[NDArray[np.bool_]]:
    """Of each motion, which candidate sees all of which voxel of its way, shape (candidates, voxels)."""
    grid, machine, solids = model_grid(VOXEL_M), model_machine(), model_solids()
    cameras = [kinect(str(n), tuple(place), False) for n, place in enumerate(places)]
    print(f"{len(cameras)} candidates", flush=True)
    found = []
    for pose in range(POSES):
        joints, met = model_pose(pose)
        view = WayView(machine, Moment(0.0, solids + link_solids(machine, joints), joints), grid)
        for motion, contact in met.items():
            way = view.way(motion, contact.travel - NEAR_VOXELS * VOXEL_M / contact.speed)
            if len(way.centres):
                found.append(np.stack([view.seen_by(camera, way.centres) for camera in cameras]))
        print(f"pose {pose + 1} of {POSES}", flush=True)
    return found


def main() -> None:
    """Prints the best four of each start."""
    places = candidates()
    ways = views_of_ways(places)
    seen = np.concatenate(ways, axis=1)
    counts = np.array([way.shape[1] for way in ways])
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])

    def shares(voxels: NDArray[np.bool_]) -> NDArray[np.float64]:
        return np.add.reduceat(voxels, firsts, dtype=np.int64) / counts

    def score(voxels: NDArray[np.bool_]) -> float:
        share = shares(voxels)
        nearly = np.clip((share - NEARLY) / (1 - NEARLY), 0, 1) + np.clip((share - 0.9) / 0.1, 0, 1)
        return float((share == 1).sum() + 0.3 * nearly.sum())

    rng = np.random.default_rng(0)
    for _ in range(STARTS):
        chosen = list(rng.choice(len(places), 4, replace=False))
        best, better = -1.0, True
        while better:
            better = False
            for n in range(4):
                others = seen[[c for m, c in enumerate(chosen) if m != n]].any(axis=0)
                scores = [score(others | one) for one in seen]
                if max(scores) > best + 1e-9:
                    best, chosen[n], better = max(scores), int(np.argmax(scores)), True
        share = shares(seen[chosen].any(axis=0))
        print(
            f"{(share == 1).sum()} of {len(ways)} ways, score {best:.2f}:",
            np.round(places[chosen], 2).tolist(),
            flush=True,
        )


if __name__ == "__main__":
    main()
