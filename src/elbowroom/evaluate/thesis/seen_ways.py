"""What candidates for a camera see of the ways of the scale model's motions, exactly and in images with noise."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.rooms.scene import WELL_KNOWN
from elbowroom.evaluate.thesis.scale import EXPLAIN_M, with_noise
from elbowroom.evaluate.thesis.scale_model import (
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
from elbowroom.geometry import DepthCamera, VoxelGrid, bits, parallel
from elbowroom.geometry.kernels.bits import bit_of, plain, word_of
from elbowroom.reconstruct import Terms
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.explained import explain
from elbowroom.reconstruct.images import room_images
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.simulate import Moment, render
from elbowroom.simulate.machine_solids import link_solids

FIRST_SEED = 10_000
"""The seeds of the noise begin beyond those that are judged."""


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


def shown(pose: int, places: NDArray[np.float64], draws: int) -> list[Shown]:
    """What each candidate sees of the way of each motion from one pose.

    Args:
        pose: number of the pose.
        places: of the candidates, shape (n, 3), world frame [m].
        draws: of noise.
    """
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
    seen = [
        _seen_from(
            place, moment, ways, [FIRST_SEED + (number * POSES + pose) * draws + n for n in range(draws)]
        )
        for number, place in enumerate(places)
    ]
    return [
        _shortened(short, np.array([of_candidate[n] for of_candidate in seen]))
        for n, short in enumerate(short_mm)
    ]


def _seen_from(
    place: NDArray[np.float64], moment: Moment, ways: Sequence[NDArray[np.float64]], seeds: Sequence[int]
) -> list[NDArray[np.bool_]]:
    """For each way what a Kinect at a place sees of its voxels: in view, through, disputed; each of shape (3, n)."""
    exact, noisy = (kinect("candidate", tuple(place), noise) for noise in (False, True))
    frame = render([exact], moment, noise=False)[0]
    clear = _evidence(exact, frame, moment, ways)
    drawn = [_evidence(noisy, with_noise(noisy, frame, [seed]), moment, ways) for seed in seeds]
    result = []
    for n, (in_view, _) in enumerate(clear):
        through = np.all([one[n][0] for one in drawn], axis=0)
        disputed = np.any([one[n][1] for one in drawn], axis=0)
        result.append(np.stack([in_view, through, disputed]))
    return result


def _evidence(
    camera: DepthCamera,
    frame: DepthFrame,
    moment: Moment,
    ways: Sequence[NDArray[np.float64]],
) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Of the voxels of each way, whether a Kinect sees through them, and whether it disputes them."""
    grid, images = model_grid(VOXEL_M), room_images([camera], [frame])
    terms = Terms(margin=WELL_KNOWN, explain_tolerance_m=EXPLAIN_M, body_growth_m=body_growth(VOXEL_M))
    at = [_words_and_bits(grid, centres) for centres in ways]
    focus = np.zeros(bits.word_count(grid), dtype=np.bool_)
    for words, _ in at:
        focus[words] = True
    with parallel.threads(1):
        explained = explain(grid, model_machine(), images, Snapshot((frame,), moment.joints), terms)
        evidence = carve_images(grid, images, explained, terms, focus=focus)
    through, disputed = evidence.through[0], evidence.disputed | evidence.unexplained
    return [((through[words] & bit) > 0, (disputed[words] & bit) > 0) for words, bit in at]


def _words_and_bits(
    grid: VoxelGrid, centres: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.uint64]]:
    """Where voxels lie in a plane."""
    lattice, (i, j, k) = bits.lattice(grid), grid.index_of(centres).T
    return plain(word_of)(i, j, k, lattice.cubes_y, lattice.cubes_z), plain(bit_of)(i, j, k)


def _shortened(short_mm: NDArray[np.float64], seen: NDArray[np.bool_]) -> Shown:
    """Of voxels that the same candidates see in the same way, only the first counts; seen: (candidates, 3, n)."""
    packed = np.ascontiguousarray(np.packbits(seen.reshape(-1, seen.shape[-1]), axis=0).T)
    _, first = np.unique(packed.view(f"V{packed.shape[1]}"), return_index=True)
    first.sort()
    return Shown(
        np.append(short_mm[first], 0.0), *(np.ascontiguousarray(seen[:, kind, first]) for kind in range(3))
    )
