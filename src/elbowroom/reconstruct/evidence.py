"""What a group of cameras knows of each voxel, as bit planes; merging is associative and commutative."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import EvidenceError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.reconstruct.kernels.planes import BLIND, DISPUTED, ONE, PLANES, SURFACE, THREE, TWO


@dataclass(frozen=True, slots=True, eq=False)
class Counts:
    """How many cameras see through each voxel, and how many dispute it; (words, 64) uint8 in the planes' order."""

    through: NDArray[np.uint8]
    disputes: NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What some cameras know of each voxel of a grid.

    Without counts (enough for rule `three`) evidence is canonical: where three cameras see through, no other plane
    says anything, and where there is a surface, blindness is not told. With counts every
    camera was asked of every voxel, as the other rules need.

    Args:
        grid: the watched box.
        cameras: names of those that it comes from, in the order of the alphabet.
        planes: (6, words) uint64: seen through by at least one, two, three; disputed; surface; blind.
        unexplained: voxels in which a return lies that the machine's model does not explain, though its body does.
        counts: numbers of cameras, or None.
        as_one: groups of cameras that were counted as one witness each, those of more than one.
        witness_angle_deg: below which cameras were one witness, as far as they were carved together [deg].

    Raises:
        EvidenceError: a camera is named twice.
    """

    grid: VoxelGrid
    cameras: tuple[str, ...]
    planes: NDArray[np.uint64]
    unexplained: Words
    counts: Counts | None = None
    as_one: frozenset[frozenset[str]] = frozenset()
    witness_angle_deg: float = 0.0

    def __post_init__(self) -> None:
        names = tuple(sorted(self.cameras))
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise EvidenceError(
                f"evidence: camera {', '.join(twice)} named twice; each camera may speak once"
            )
        object.__setattr__(self, "cameras", names)
        if self.counts is None:
            self.planes[DISPUTED:] &= ~self.planes[THREE]
            self.planes[BLIND] &= ~self.planes[SURFACE]
        for array in (self.planes, self.unexplained):
            array.setflags(write=False)

    @classmethod
    def nothing(cls, grid: VoxelGrid, complete: bool = False) -> "Evidence":
        """The evidence of no camera at all: nothing is known."""
        words = bits.word_count(grid)
        zeros = np.zeros((words, 64), dtype=np.uint8)
        counts = Counts(zeros, zeros.copy()) if complete else None
        return cls(grid, (), np.zeros((PLANES, words), dtype=np.uint64), bits.empty(grid), counts)

    @classmethod
    def from_mask(
        cls, grid: VoxelGrid, name: str, seen_through: NDArray[np.bool_], surface: NDArray[np.bool_]
    ) -> "Evidence":
        """The evidence of any other sensor (thesis section 7), to be merged like that of a camera.

        Args:
            grid: the watched box.
            name: of the sensor; unique among cameras and sensors.
            seen_through: bool, shape of the grid: the sensor saw all of the voxel to be empty.
            surface: bool, shape of the grid: it measured something there. Where both are set, surface holds.

        Raises:
            GridError: an array of another shape or type.
        """
        through = bits.pack(seen_through & ~surface, grid)
        measured = bits.pack(surface, grid)
        planes = np.zeros((PLANES, bits.word_count(grid)), dtype=np.uint64)
        planes[ONE], planes[DISPUTED], planes[SURFACE] = through, measured, measured
        counts = Counts(
            *(np.unpackbits(p.view(np.uint8), bitorder="little").reshape(-1, 64) for p in (through, measured))
        )
        return cls(grid, (name,), planes, bits.empty(grid), counts)

    @property
    def through(self) -> tuple[Words, Words, Words]:
        """Planes: seen through by at least one, two, three."""
        return self.planes[ONE], self.planes[TWO], self.planes[THREE]

    @property
    def disputed(self) -> Words:
        """Plane: some camera that looks there cannot say "through"."""
        return self.planes[DISPUTED]

    @property
    def surface(self) -> Words:
        """Plane: some camera measured a surface there."""
        return self.planes[SURFACE]

    @property
    def blind(self) -> Words:
        """Plane: some camera that looks there delivered nothing valid."""
        return self.planes[BLIND]


def merge(parts: Sequence[Evidence]) -> Evidence:
    """What several groups of cameras know together. Order and grouping leave the same bits.

    Args:
        parts: at least one; evidence with counts merged with some without loses them.

    Raises:
        EvidenceError: no parts, unlike grids, or a camera named twice.
    """
    if not parts:
        raise EvidenceError("merge: nothing to merge, at least one evidence is needed")
    merged = parts[0]
    for part in parts[1:]:
        merged = _merge_two(merged, part)
    return merged


def _merge_two(a: Evidence, b: Evidence) -> Evidence:
    if a.grid != b.grid:
        raise EvidenceError(f"merge: unlike grids, {a.grid} and {b.grid}")
    planes = a.planes | b.planes
    planes[TWO] |= a.planes[ONE] & b.planes[ONE]
    planes[THREE] |= (a.planes[TWO] & b.planes[ONE]) | (a.planes[ONE] & b.planes[TWO])
    counts = None
    if a.counts is not None and b.counts is not None:
        if len(a.cameras) + len(b.cameras) > 255:
            raise EvidenceError("merge: more than 255 cameras cannot be counted")
        counts = Counts(a.counts.through + b.counts.through, a.counts.disputes + b.counts.disputes)
    groups, angle_deg = a.as_one | b.as_one, max(a.witness_angle_deg, b.witness_angle_deg)
    return Evidence(
        a.grid, a.cameras + b.cameras, planes, a.unexplained | b.unexplained, counts, groups, angle_deg
    )
