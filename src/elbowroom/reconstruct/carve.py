"""Frames of any group of cameras -> evidence."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import Detail
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kernels.bits import Lattice
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Explained
from elbowroom.reconstruct.evidence import Counts, Evidence, merge
from elbowroom.reconstruct.images import RoomImages, room_images
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.carve import carve_cubes
from elbowroom.reconstruct.kernels.planes import PLANES, Answers
from elbowroom.reconstruct.kernels.points import carve_points
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.parts import KeptViews, widened
from elbowroom.reconstruct.regions import regions
from elbowroom.reconstruct.terms import Terms
from elbowroom.reconstruct.views import fill
from elbowroom.reconstruct.witnesses import as_one, witnesses
from elbowroom.sensing import DepthFrame

SHARES = 16


Carver = Callable[[NDArray[np.int64], Lattice, Views, Answers], None]
"""Asks all cameras of the voxels of some cubes of 16 voxels, by number, and writes the answers."""


def carve(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    *,
    detail: Detail = "pixel",
    margin: Margin | None = None,
    complete: bool = False,
    model_depth: Mapping[str, NDArray[np.float32]] | None = None,
    unexplained: Words | None = None,
) -> Evidence:
    """What cameras know of each voxel by one frame each. A camera without a frame disputes all that it looks at.

    Cameras nearer to each other than `terms.WITNESS_ANGLE_DEG` are one witness (`witnesses`).

    Args:
        grid: the watched box.
        cameras: a group of cameras, in any order.
        frames: at most one of each of them.
        detail: "footprint": a voxel is through if all pixels around its footprint lie behind it; "pixel": if every
            pixel whose widened cone meets it lies behind where the cone leaves it; "point": the thesis' test of
            centres (section 3.1), for comparison.
        margin: for cameras without one of their own; None: `Margin()`.
        complete: ask all cameras of every voxel and count them, as rules other than `three` need.
        model_depth: by camera, up to where the machine explains each pixel [m], 0: not explained (`machine.explain`).
        unexplained: plane of voxels in which returns lie that the machine does not explain.

    Raises:
        InputError: an unknown detail.
        CameraError: a camera named twice, a frame of an unknown camera, or more than 255 cameras.
        FrameError: two frames of one camera, or a frame of another size than its camera's.
    """
    terms = Terms(detail=detail, margin=margin or Margin())
    explained = Explained(dict(model_depth or {}), unexplained)
    return carve_images(grid, room_images(cameras, frames), explained, terms, complete=complete)


def carve_aged(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    aged_m: Mapping[str, float],
    *,
    detail: Detail = "pixel",
    margin: Margin | None = None,
    complete: bool = False,
) -> Evidence:
    """As `carve`, of frames since which things may have moved: a voxel is through if it is, grown by so much.

    Args:
        grid, cameras, frames: as of `carve`.
        aged_m: by camera, how far anything may have moved since its frame [m]; one that is missing: not at all.
        detail, margin, complete: as of `carve`.

    Raises:
        InputError, CameraError, FrameError: as `carve`.
    """
    terms = Terms(detail=detail, margin=margin or Margin())
    images = room_images(cameras, frames, aged_m)
    return carve_images(grid, images, Explained({}, None), terms, complete=complete)


def carve_images(
    grid: VoxelGrid,
    images: RoomImages,
    explained: Explained,
    terms: Terms,
    *,
    complete: bool = False,
    focus: NDArray[np.bool_] | None = None,
    kept: list[KeptViews] | None = None,
    carver: Carver | None = None,
) -> Evidence:
    """As `carve`, from images that are pinhole already.

    Args:
        grid: the watched box.
        images: of a group of cameras.
        explained: what the machine explains of them.
        terms: detail and margin.
        complete: as of `carve`.
        focus: blocks of 4 voxels, in the planes' order, that are asked of the cameras; of the others nothing is known
            afterwards. None: all.
        kept: takes the images as kernels have them, to be asked again; None: they are let go.
        carver: who asks the cameras by detail `pixel`; None: the threads of this computer.

    Raises:
        CameraError: more than 255 cameras.
    """
    groups = witnesses(grid, images.cameras, terms.witness_angle_deg)
    names = [camera.name for camera in images.cameras]
    near = [[names[number] for number in group] for group in groups]
    alone = [name for name in names if not any(name in group for group in near)]
    own = _Carve(grid, terms, complete, focus, carver=carver)(
        images.of(*alone) if near else images, explained, kept
    )
    rest = replace(explained, unexplained_words=None)
    # of one witness every camera is asked, also where several see through: who disputes counts
    as_one_witness = _Carve(grid, terms, True, focus, True, carver)
    shared = (as_one_witness(images.of(*group), rest, kept) for group in near)
    return merge([own, *(as_one([one], complete) for one in shared)])


@dataclass(frozen=True, slots=True, eq=False)
class _Carve:
    """As `carve_images`, for some cameras.

    Args:
        grid, terms, complete, focus: as of `carve_images`.
        as_one: whether these cameras are one witness.
        carver: as of `carve_images`.
    """

    grid: VoxelGrid
    terms: Terms
    complete: bool
    focus: NDArray[np.bool_] | None
    as_one: bool = False
    carver: Carver | None = None

    def __call__(self, images: RoomImages, explained: Explained, kept: list[KeptViews] | None) -> Evidence:
        layout = layout_of(self.grid, images.cameras, self.terms.margin)
        asked = (
            layout.inside.copy() if self.focus is None else np.where(self.focus, layout.inside, np.uint64(0))
        )
        left = asked if explained.decided_words is None else asked & ~explained.decided_words
        answers = _no_answers(left, self.terms.detail, self.complete)
        lattice, worth = bits.lattice(self.grid), _cubes_with(asked)
        carver = self.carver or (_by_points if self.terms.detail == "point" else _by_voxels)
        # of other details windows decide, and they reach beyond what the pixel test asks
        within = regions(layout, asked, worth, images.aged_m) if self.terms.detail == "pixel" else None
        views, buffers = fill(layout, images, explained.model_depth, within)
        carved = KeptViews(views if kept is None else widened(views), self.as_one)
        # its memory is used again when nobody has it any more
        finalize(carved, layout.give_back, buffers)
        carver(worth if left is asked else _cubes_with(left), lattice, views, answers)
        if kept is not None:
            kept.append(carved)
        return Evidence(
            self.grid,
            tuple(camera.name for camera in images.cameras),
            answers.planes,
            bits.empty(self.grid) if explained.unexplained_words is None else explained.unexplained_words,
            Counts(answers.through_count, answers.dispute_count) if self.complete else None,
            witness_angle_deg=self.terms.witness_angle_deg,
        )


def _cubes_with(asked: Words) -> NDArray[np.int64]:
    """Numbers of the cubes that hold voxels that are asked."""
    return np.flatnonzero(asked.reshape(-1, 64).any(axis=1))


def _by_voxels(cubes: NDArray[np.int64], lattice: Lattice, views: Views, answers: Answers) -> None:
    """Asks cameras coarse to fine, each thread its own cubes."""
    spread(
        lambda share: carve_cubes(np.ascontiguousarray(cubes[share::SHARES]), lattice, views, answers),
        range(min(SHARES, len(cubes))),
    )


def _by_points(cubes: NDArray[np.int64], lattice: Lattice, views: Views, answers: Answers) -> None:
    """Asks cameras of the voxels' centres, each thread its own cubes."""
    spread(
        lambda share: carve_points(np.ascontiguousarray(cubes[share::SHARES]), lattice, views, answers),
        range(min(SHARES, len(cubes))),
    )


def _no_answers(asked: Words, detail: Detail, complete: bool) -> Answers:
    """What is asked, and planes and counts that say nothing yet."""
    words = len(asked)
    counts = (np.zeros((words if complete else 0, 64), dtype=np.uint8) for _ in range(2))
    planes = np.zeros((PLANES, words), dtype=np.uint64)
    return Answers(asked, np.full(words, detail == "pixel"), complete, planes, *counts)
