"""Where the scale model's four Kinects stand: from where exact rays reach most of the motions' ways.

    python benchmarks/scale_cameras.py

Candidates stand on rings about the middle of the C. For each motion that the evaluation judges, every voxel of its way
is asked of every candidate: is all of it in view? Then four are chosen, one exchanged at a time, that have the most
ways in view up to two voxels before the contact. First all candidates with coarse voxels, then those near the best
fours with the voxels of the evaluation. No image, no noise and no verdict plays a part. It takes a quarter of an hour.
"""

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.scale import NEAR_VOXELS
from elbowroom.evaluate.scale_model import (
    AIM_M,
    LABORATORY,
    POSES,
    VOXEL_M,
    body_growth,
    kinect,
    model_grid,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.way_view import WayView
from elbowroom.simulate import Moment
from elbowroom.simulate.machine_solids import link_solids

DISTANCES_M, AZIMUTHS_DEG = (0.75, 0.8, 0.85, 0.9), range(0, 360, 20)
HEIGHTS_M = (0.03, 0.12, 0.25, 0.45, 0.7, 0.9)
CLEAR_M = 0.53
"""Nothing is nearer to a Kinect than this, which measures from 0.5 m on [m]."""
COARSE_M = 0.004
"""Edge of the voxels of the first search [m]."""
BEST, NEAR_BEST_M = 6, 0.12
"""The second search is among the places this near to those of so many best fours [m]."""
STARTS = 30


class SeenWay(NamedTuple):
    """Which candidate sees all of which voxel of a way, voxels in the order in which they are met.

    Args:
        share: of the way, up to two voxels before the contact, at which each voxel is met, shape (n,).
        seen: shape (candidates, n).
    """

    share: NDArray[np.float64]
    seen: NDArray[np.bool_]

    def of(self, chosen: list[int]) -> float:
        """The share of the way that is in view of some candidates."""
        seen = self.seen[chosen].any(axis=0)
        return 1.0 if seen.all() else float(self.share[np.argmin(seen)])


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


def seen_ways(places: NDArray[np.float64], voxel_size_m: float) -> list[SeenWay]:
    """What each candidate sees of each motion's way."""
    grid, machine, solids = model_grid(voxel_size_m), model_machine(), model_solids()
    cameras = [kinect(str(n), tuple(place), False) for n, place in enumerate(places)]
    print(f"{len(cameras)} candidates, voxels of {1000 * voxel_size_m:g} mm", flush=True)
    found = []
    for pose in range(POSES):
        joints, met = model_pose(pose)
        view = WayView(
            machine,
            Moment(0.0, solids + link_solids(machine, joints), joints),
            grid,
            body_growth(voxel_size_m),
        )
        for motion, contact in met.items():
            length = contact.travel - NEAR_VOXELS * voxel_size_m / contact.speed
            way = view.way(motion, length)
            if len(way.centres):
                order = np.argsort(way.travel, kind="stable")
                seen = np.stack([view.seen_by(camera, way.centres[order]) for camera in cameras])
                found.append(_shortened(way.travel[order] / length, seen))
        print(f"pose {pose + 1} of {POSES}", flush=True)
    return found


def _shortened(share: NDArray[np.float64], seen: NDArray[np.bool_]) -> SeenWay:
    """Of voxels that the same candidates see, only the first counts."""
    packed = np.ascontiguousarray(np.packbits(seen, axis=0).T)
    _, first = np.unique(packed.view(f"V{packed.shape[1]}"), return_index=True)
    first.sort()
    return SeenWay(share[first], np.ascontiguousarray(seen[:, first]))


def best_fours(ways: list[SeenWay], count: int) -> list[tuple[float, list[int]]]:
    """Fours of candidates that cannot be bettered by exchanging one, the best first, with their scores."""

    def score(chosen: list[int]) -> float:
        shares = np.array([way.of(chosen) for way in ways])
        # so that the search has a slope to climb
        return float((shares == 1).sum() + 0.5 * shares.mean())

    rng, found = np.random.default_rng(0), []
    for _ in range(STARTS):
        chosen = rng.choice(count, 4, replace=False).tolist()
        best, better = score(chosen), True
        while better:
            better = False
            for n in range(4):
                scores = [score([*chosen[:n], one, *chosen[n + 1 :]]) for one in range(count)]
                if max(scores) > best:
                    best, chosen[n], better = max(scores), int(np.argmax(scores)), True
        found.append((best, sorted(chosen)))
    return sorted(found, reverse=True)


def main() -> None:
    """Prints the best fours of both searches."""
    places = candidates()
    for voxel_size_m in (COARSE_M, VOXEL_M):
        fours = best_fours(seen_ways(places, voxel_size_m), len(places))
        for score, chosen in fours[:BEST]:
            print(f"score {score:.2f}:", np.round(places[chosen], 2).tolist(), flush=True)
        core = places[sorted({one for _, chosen in fours[:BEST] for one in chosen})]
        away = np.linalg.norm(places[:, None] - core[None], axis=2).min(axis=1)
        places = places[away <= NEAR_BEST_M]


if __name__ == "__main__":
    main()
