"""Where the scale model's four Kinects stand: from where they see most of the motions' ways, and lose little to noise.

    python benchmarks/scale_cameras.py

Candidates stand on rings about the middle of the C. For each motion that the evaluation judges, every voxel of its way
is asked of every candidate: does it see through it in an exact image? And in images with noise, does it see through
it, or dispute it? A camera that looks at an object from the front keeps three sigmas clear of it and disputes them, one
that looks past it does not. The noise is another than the one that is judged, and of two draws the worse counts. Then
four candidates are chosen, one exchanged at a time, that have the most ways in view for which what is due holds: half
of them short by less than the median that is due, none by more than the worst, nor any that is all but in view. First
among candidates far apart, then among closer ones about the best fours. It takes some twenty minutes on two cores.
"""

import itertools
import os
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.rooms.scene import WELL_KNOWN
from elbowroom.evaluate.thesis.scale import EXPLAIN_M, near_m, with_noise
from elbowroom.evaluate.thesis.scale_model import (
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
from elbowroom.evaluate.thesis.way_view import WayView
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.machine import explain_frames
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, render
from elbowroom.simulate.machine_solids import link_solids

RINGS = (np.arange(0.65, 0.91, 0.05), np.arange(0, 360, 20), (0.03, 0.12, 0.25, 0.45, 0.7, 0.9))
"""Distances [m], azimuths [degrees] and heights [m] of the candidates of the first search."""
CLOSER_RINGS = (np.arange(0.65, 0.96, 0.05), np.arange(0, 360, 5), np.arange(0.03, 0.95, 0.07))
"""And of the second."""
BEST, NEAR_BEST_M = 3, 0.085
"""The second search is among the places this near to those of so many best fours [m]."""
CLEAR_M = 0.53
"""Nothing is nearer to a Kinect than this, which measures from 0.5 m on [m]."""
FIRST_SEED = 10_000
"""The seeds of the noise begin beyond those that are judged."""
STARTS = 20
MEDIAN_MM, WORST_MM = 4.8, 11.0
"""What is due, 5 and 12, with a little to spare, since other noise is judged."""
ALL_BUT_IN_VIEW = 2
"""The worst that is due is asked of ways that would be in view with so many times the limit, too.

Else the search puts what is bad just beyond it.
"""


class Shown(NamedTuple):
    """What candidates see of a way, voxels in the order in which they are met; the last is the contact, seen by none.

    Args:
        short_mm: how long before the contact each voxel is met, shape (n,) [mm].
        in_view: the candidate sees through the voxel in an exact image, shape (candidates, n).
        through: the candidate sees through it, in every draw of noise, shape (candidates, n).
        disputed: it disputes it, in some draw, shape (candidates, n).
    """

    short_mm: NDArray[np.float64]
    in_view: NDArray[np.bool_]
    through: NDArray[np.bool_]
    disputed: NDArray[np.bool_]


def on_rings(
    distances_m: Sequence[float], azimuths_deg: Sequence[float], heights_m: Sequence[float]
) -> NDArray[np.float64]:
    """Places that are clear of model and machine, shape (n, 3) [m]."""
    places = []
    for distance, azimuth, height in itertools.product(distances_m, np.radians(azimuths_deg), heights_m):
        across_squared = distance**2 - (height - AIM_M[2]) ** 2
        if across_squared > 0.1:
            across = np.sqrt(across_squared)
            places.append((across * np.cos(azimuth), across * np.sin(azimuth), height))
    near = np.concatenate([s.vertices_in_world for s in model_solids() if s.name not in LABORATORY])
    links = [link_solids(model_machine(), model_pose(pose)[0]) for pose in range(POSES)]
    near = np.concatenate([near, *(s.vertices_in_world for solids in links for s in solids)])
    clear = [np.linalg.norm(near - place, axis=1).min() > CLEAR_M for place in places]
    return np.array(places)[clear]


def shown(pose: int, places: NDArray[np.float64], draws: int) -> list[Shown]:
    """What each candidate sees of the way of each motion from one pose, in so many draws of noise."""
    grid, machine, solids = model_grid(VOXEL_M), model_machine(), model_solids()
    joints, met = model_pose(pose)
    moment = Moment(0.0, solids + link_solids(machine, joints), joints)
    view = WayView(machine, moment, grid, body_growth(VOXEL_M))
    ways, short_mm = [], []
    for motion, contact in met.items():
        way = view.way(motion, contact.travel)
        if len(way.travel):
            order = np.argsort(way.travel, kind="stable")
            ways.append(way.centres[order])
            short_mm.append(1000 * (contact.travel - way.travel[order]) * contact.speed)
    rows: list[list[NDArray[np.bool_]]] = [[] for _ in ways]
    for number, place in enumerate(places):
        exact, noisy = (kinect("candidate", tuple(place), noise) for noise in (False, True))
        frame = render([exact], moment, noise=False)[0]
        clear = _evidence(grid, exact, frame, joints, ways)
        first = FIRST_SEED + (number * POSES + pose) * draws
        seen = [
            _evidence(grid, noisy, with_noise(noisy, frame, [first + draw]), joints, ways)
            for draw in range(draws)
        ]
        for n, row in enumerate(rows):
            through = np.all([one[n][0] for one in seen], axis=0)
            disputed = np.any([one[n][1] for one in seen], axis=0)
            row.append(np.stack([clear[n][0], through, disputed]))
    return [_shortened(short, np.array(row)) for short, row in zip(short_mm, rows, strict=True)]


def _evidence(
    grid: VoxelGrid,
    camera: DepthCamera,
    frame: DepthFrame,
    joints: Mapping[str, float],
    ways: Sequence[NDArray[np.float64]],
) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Of the voxels of each way, whether a Kinect sees through them, and whether it disputes them."""
    images = room_images([camera], [frame])
    explained = explain_frames(
        model_machine(),
        [camera],
        [images.least_m[camera.name]],
        [joints],
        tolerance_m=EXPLAIN_M,
        grid=grid,
        growth_m=body_growth(VOXEL_M),
    )
    at = [_words_and_bits(grid, centres) for centres in ways]
    focus = np.zeros(bits.word_count(grid), dtype=np.bool_)
    for words, _ in at:
        focus[words] = True
    evidence = carve_images(
        grid,
        images,
        explained,
        Terms(margin=WELL_KNOWN),
        focus=focus,
    )
    through, disputed = evidence.through[0], evidence.disputed | evidence.unexplained
    return [((through[words] & bit) > 0, (disputed[words] & bit) > 0) for words, bit in at]


def _words_and_bits(
    grid: VoxelGrid, centres: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.uint64]]:
    """Where voxels lie in a plane."""
    cells, (i, j, k) = bits.lattice(grid), grid.index_of(centres).T
    return bits.word_of.py_func(i, j, k, cells.cubes_y, cells.cubes_z), bits.bit_of.py_func(i, j, k)


def _shortened(short_mm: NDArray[np.float64], seen: NDArray[np.bool_]) -> Shown:
    """Of voxels that the same candidates see in the same way, only the first counts; seen: (candidates, 3, n)."""
    packed = np.ascontiguousarray(np.packbits(seen.reshape(-1, seen.shape[-1]), axis=0).T)
    _, first = np.unique(packed.view(f"V{packed.shape[1]}"), return_index=True)
    first.sort()
    return Shown(
        np.append(short_mm[first], 0.0), *(np.ascontiguousarray(seen[:, kind, first]) for kind in range(3))
    )


def shortfalls(
    ways: Sequence[Shown], chosen: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """For three candidates and each further one: by how much each way is short of the contact.

    Returns:
        What is in view of none of the four, and what is not free by rule `three` [mm]; shape (candidates, ways).
    """
    hidden, blocked = [], []
    for way in ways:
        count = way.through[chosen].sum(axis=0, dtype=np.uint8) + way.through
        disputed = way.disputed[chosen].any(axis=0) | way.disputed
        hidden.append(_first_missing(way, way.in_view[chosen].any(axis=0) | way.in_view))
        blocked.append(_first_missing(way, (count >= 3) | ((count >= 1) & ~disputed)))
    return np.array(hidden).T, np.array(blocked).T


def _first_missing(way: Shown, has: NDArray[np.bool_]) -> NDArray[np.float64]:
    first = np.where(has.all(axis=1), has.shape[1], np.argmin(has, axis=1))
    return way.short_mm[first]


def scores(hidden_mm: NDArray[np.float64], blocked_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """The ways in view for which what is due holds, four less for each that is too short by the worst."""
    in_view = hidden_mm <= 1000 * near_m(VOXEL_M)
    good = (in_view & (blocked_mm <= MEDIAN_MM)).sum(axis=1)
    near = hidden_mm <= 1000 * ALL_BUT_IN_VIEW * near_m(VOXEL_M)
    bad = (near & (blocked_mm > WORST_MM)).sum(axis=1)
    # the last term gives the search a slope to climb
    slope = np.clip(1 - blocked_mm / 60, 0, 1).mean(axis=1)
    return np.minimum(in_view.sum(axis=1), 2 * good - 1) - 4 * bad + 0.5 * slope


def best_fours(ways: Sequence[Shown], count: int) -> list[tuple[float, list[int]]]:
    """Fours of candidates that cannot be bettered by exchanging one, the best first, with their scores."""
    rng, found = np.random.default_rng(0), {}
    for _ in range(STARTS):
        chosen, best, better = rng.choice(count, 4, replace=False).tolist(), -np.inf, True
        while better:
            better = False
            for n in range(4):
                now = scores(*shortfalls(ways, chosen[:n] + chosen[n + 1 :]))
                if now.max() > best + 1e-9:
                    best, chosen[n], better = float(now.max()), int(now.argmax()), True
        found[tuple(sorted(chosen))] = best
    return sorted(((best, list(four)) for four, best in found.items()), reverse=True)


def search(places: NDArray[np.float64], draws: int) -> NDArray[np.float64]:
    """The best fours among some places, by so many draws of noise, shape (fours, 4, 3), told with what they see."""
    print(f"{len(places)} candidates", flush=True)
    ways: list[Shown] = []
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        for pose, more in enumerate(
            pool.map(shown, range(POSES), itertools.repeat(places), itertools.repeat(draws))
        ):
            ways += more
            print(f"pose {pose + 1} of {POSES}", file=sys.stderr, flush=True)
    fours = best_fours(ways, len(places))[: 2 * BEST]
    for score, chosen in fours:
        hidden, blocked = (mm[chosen[3]] for mm in shortfalls(ways, chosen[:3]))
        mine, near = (blocked[hidden <= 1000 * more * near_m(VOXEL_M)] for more in (1, ALL_BUT_IN_VIEW))
        print(
            f"score {score:.2f}: {len(mine)} ways in view, short by {np.median(mine):.1f} / {mine.max():.1f} mm, "
            f"{len(near)} all but in view, by {np.median(near):.1f} / {near.max():.1f} mm, "
            f"all by {np.median(blocked):.1f} mm: {np.round(places[chosen], 3).tolist()}",
            flush=True,
        )
    return np.array([places[chosen] for _, chosen in fours[:BEST]])


def main() -> None:
    """Prints the best fours of both searches."""
    best = search(on_rings(*RINGS), 1).reshape(-1, 3)
    closer = on_rings(*CLOSER_RINGS)
    away = np.linalg.norm(closer[:, None] - best[None], axis=2).min(axis=1)
    search(closer[away <= NEAR_BEST_M], 2)


if __name__ == "__main__":
    main()
