"""The space that links move in: all but those that may touch what it stands on, or go unwatched, share one."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.stand import ROUNDING_IN_VOXELS, Stand
from elbowroom.machine.zone_words import zone_words
from elbowroom.motion.kernels.volume import Volume
from elbowroom.motion.sweep import Block, volume_of
from elbowroom.reconstruct.free_space import NO_PARTS, FreeSpace, Index
from elbowroom.reconstruct.point_report import PointReport


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A space, and the links whose way it may end.

    Args:
        space: with the voxels made free that these links may touch, and zones blocked; nobody else gets to see it.
        volume: of the space, as kernels take it.
        links: whether each link is one of them, shape (n_links,).
    """

    space: FreeSpace
    volume: Volume
    links: NDArray[np.bool_]


def grounds_of(space: FreeSpace, machine: Machine) -> tuple[Ground, ...]:
    """One for each set of links that may touch the same boxes and go unwatched in the same zones; each link is in one.

    Args:
        space: what the machine moves in.
        machine: says what its links may touch, and where they may be.
    """
    spared = [_spared(machine, link) for link in machine.link_names]
    kept_out = _kept_out(machine, space.grid)
    grounds = []
    for own in sorted(set(spared)):
        stands, unwatched, near = own
        free = space.free_words
        if stands:
            free = free | _stood_on(machine, space, stands)
        if unwatched:
            free = free | _unwatched(machine, space, unwatched)
        if near and space.declared:
            free = np.bitwise_or.reduce([free, *(space.declared[n] for n in near)])
        there = _with(space, free, kept_out)
        grounds.append(Ground(there, volume_of(there), np.array([other == own for other in spared])))
    return tuple(grounds)


def zone_of(block: Block, space: FreeSpace, machine: Machine) -> str | None:
    """The zone that ends a way there because links are kept out of it; None: something else does.

    Args:
        block: what ends the way.
        space: what cameras saw.
        machine: says where its links may be.
    """
    place, grid = block.place_in_world, space.grid
    if not machine.zones or not grid.contains(place):
        return None
    i, j, k = (int(n) for n in grid.index_of(place))
    word, bit = bits.place_of((i, j, k), grid)
    if space.surface_words[word] & bit:
        return None
    for zone in machine.zones:
        if zone.kind == "kept_out" and zone_words(zone, grid, False)[word] & bit:
            return zone.name
    return None


def _spared(machine: Machine, link: str) -> tuple[tuple[int, ...], ...]:
    """The stands that a link may touch, the zones that are not watched for it, and the things that it may be near."""
    stands = tuple(n for n, stand in enumerate(machine.stands) if stand.names(link))
    zones = tuple(n for n, zone in enumerate(machine.zones) if zone.names(link))
    return stands, zones, tuple(n for n, contact in enumerate(machine.contacts) if contact.names(link))


def _kept_out(machine: Machine, grid: VoxelGrid) -> Words | None:
    """The plane of the voxels that zones to keep out of touch; None: there are none."""
    planes = [zone_words(zone, grid, False) for zone in machine.zones if zone.kind == "kept_out"]
    return np.bitwise_or.reduce(planes) if planes else None


def _unwatched(machine: Machine, space: FreeSpace, zones: tuple[int, ...]) -> Words:
    """The voxels that lie wholly in one of some zones, that cameras were asked of, and that nobody disputes."""
    within = np.bitwise_or.reduce([zone_words(machine.zones[n], space.grid, True) for n in zones])
    within = within & ~(space.surface_words | space.blind_words | space.disputed_words)
    return within if space.looked_at is None else np.where(space.looked_at, within, np.uint64(0))


def _with(space: FreeSpace, free: Words, kept_out: Words | None) -> FreeSpace:
    """The space with other voxels free, and some blocked as if something stood there.

    Args:
        space: what cameras saw.
        free: what is free.
        kept_out: what is blocked all the same; None: nothing.
    """
    if kept_out is None:
        return space if free is space.free_words else replace(space, free_words=free)
    return replace(
        space,
        free_words=free & ~kept_out,
        surface_words=space.surface_words | kept_out,
        source=None if space.source is None else _AskedOf(space, kept_out),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _AskedOf:
    """Answers of a space for one that is blocked in more places, of which no part is free."""

    space: FreeSpace
    kept_out: Words

    def report(self, space: FreeSpace, index: Index) -> PointReport:
        assert self.space.source is not None
        return self.space.source.report(self.space, index)

    def free_parts(self, space: FreeSpace, index: Index) -> np.uint64:
        word, bit = bits.place_of(index, self.space.grid)
        return NO_PARTS if self.kept_out[word] & bit else self.space.free_parts(index)


def _stood_on(machine: Machine, space: FreeSpace, stands: tuple[int, ...]) -> Words:
    """The plane of the voxels that lie wholly in one of some stands, but for columns of which something stands out.

    What stands on a table stands out of the box at its top, where no link is. There whatever is seen or disputed in the
    voxel above blocks the column beneath, and those beside it: less evidence gives none back.
    """
    grid, planes = space.grid, []
    known = space.surface_words | space.blind_words | space.disputed_words
    for n in stands:
        words = _words_in(machine.anywhere, grid, n)
        i, j, k = _voxels_in(machine.stands[n], grid)
        if i.stop > i.start and j.stop > j.start and 0 < k.stop < grid.shape[2]:
            a, b = np.nonzero(_beside(_layer(known, grid, i, j, k.stop)))
            heights = np.arange(k.start, k.stop)
            columns = np.repeat(a + i.start, heights.size), np.repeat(b + j.start, heights.size)
            word, bit = bits.places_of(*columns, np.tile(heights, a.size), grid)
            words = words.copy()
            np.bitwise_and.at(words, word, ~bit)
        planes.append(words)
    return np.bitwise_or.reduce(planes)


@kept
def _words_in(machine: Machine, grid: VoxelGrid, stand: int) -> Words:
    """The plane of the voxels that lie wholly in one of a machine's stands."""
    mask = np.zeros(grid.shape, dtype=np.bool_)
    mask[_voxels_in(machine.stands[stand], grid)] = True
    return bits.pack(mask, grid)


def _layer(words: Words, grid: VoxelGrid, i: slice, j: slice, k: int) -> NDArray[np.bool_]:
    """The bits of one layer of voxels.

    Args:
        words: a plane.
        grid: its grid.
        i, j, k: which voxels.
    """
    a, b = np.meshgrid(np.arange(i.start, i.stop), np.arange(j.start, j.stop), indexing="ij")
    word, bit = bits.places_of(a, b, np.full_like(a, k), grid)
    return np.asarray((words[word] & bit) != 0)


def _beside(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """What is set, and its eight neighbours, shape (n, m)."""
    padded = np.pad(mask, 1)
    sides = [padded[a : a + mask.shape[0], b : b + mask.shape[1]] for a in range(3) for b in range(3)]
    return np.asarray(np.logical_or.reduce(sides))


def _voxels_in(stand: Stand, grid: VoxelGrid) -> tuple[slice, ...]:
    first = np.ceil((stand.lower_m - grid.lower_m) / grid.voxel_size_m - ROUNDING_IN_VOXELS)
    stop = np.floor((stand.upper_m - grid.lower_m) / grid.voxel_size_m + ROUNDING_IN_VOXELS)
    within = np.clip(np.stack([first, stop]), 0, grid.shape).astype(np.int64)
    return tuple(slice(int(a), int(b)) for a, b in within.T)
