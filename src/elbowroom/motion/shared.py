"""Blocked voxels that the machine reaches into where it stands: what leads out of them is let go.

Something stands within a voxel of the body, and so the voxel is blocked as a whole, and the body is in it. Were a
motion stopped wherever the body meets it, all motions would stop, those that lead away as well. So of such a voxel only
that part blocks which the body does not cover at the start:

    B' = B \\ cells( M(0) grown by g0 )             cells: sixteenths of a voxel's edge
    eps = g0 + sqrt(3) h / 16                      how far a cell that is taken out may reach from the body

with the blocked space B, the solid body M(t) after travel t, the voxel's edge h. No object lies in M(0), so what stands
farther than eps from it lies in B', and the surface of M passes it before M covers it. What stands nearer is pressed by
eps at most; so a motion that ends at a voxel within eps of the link that meets it ends earlier, by as much travel as
the slowest part that may come there needs for 2 eps; and before its links may press what they reach into by more than
a hair (`motion.outward`). Less evidence leaves more of B, so more of B'.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kernels.bits import Lattice, plain
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.motion.course import Way
from elbowroom.motion.ground import Ground
from elbowroom.motion.kernels.covered import open_cells, reached
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.kernels.outward import Boxes
from elbowroom.motion.kernels.shared import CELLS, WORDS, Shared
from elbowroom.motion.kernels.sweep import Asked
from elbowroom.motion.kernels.touched import NOTHING, kind_of
from elbowroom.motion.kernels.volume import Volume
from elbowroom.motion.outward import faces_of, first_pressed
from elbowroom.motion.pieces import checked_rows, pieces
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import Block, find_block, marked
from elbowroom.reconstruct.free_space import Index

GROWTH_M = 0.0015
"""g0, at least: the facets of round links slide along in it, which stand out by a millimetre on a large arc [m]."""
GROWTH_IN_VOXELS = 1 / 16
"""And at least this: twice what a patch is grown by in the sweep's shortest intervals [voxel edges]."""
MOST_SHARED = 512
"""A machine that reaches into more blocked voxels stands in the dark: none of its motions is let go."""
ROOM_FOR = 1 << 16
"""So many finds of such voxels are written, one after another from sample to sample."""
AT_ONCE = 8
"""Voxels whose cells a thread looks at before it takes the next."""
HALF_DIAGONAL = np.sqrt(0.75)
ALL_CELLS = ~np.uint64(0)
"""Of one part of a voxel; a part is a block of 4 cells along each axis."""


class Ends(NamedTuple):
    """The first blocks on a way: of what links do not reach into where they stand, and of what they do."""

    about: Block | None
    within: Block | None

    @property
    def first(self) -> Block | None:
        """The first of both."""
        blocks = [block for block in self if block is not None]
        return min(blocks, key=lambda block: (block.travel, block.kind), default=None)


_AT_ONCE = Block(0.0, NOTHING, -1, np.zeros(3))
NOT_LOOKED = Ends(_AT_ONCE, _AT_ONCE)
"""Before the first look: blocks may be anywhere."""


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A ground, and the blocked voxels that the machine reaches into where it stands.

    Args:
        ground: its volume blocks links wherever they do not reach at the start.
        within: what blocks links there; None: they reach into nothing.
        near_m: eps [m].
        placed: where links are at the start, shape (n_links, 4, 4).
        reached: the voxels that links reach into, and their cells that the body does not cover.
        parts: of voxels that cameras were asked of again, by number, the cells that are blocked, shape (64,).
    """

    ground: Ground
    within: Volume | None
    near_m: float
    placed: NDArray[np.float64]
    reached: Shared
    parts: Mapping[int, Words] = field(default_factory=dict)

    @classmethod
    def of(cls, machine: Machine, ground: Ground, placed: NDArray[np.float64]) -> Self:
        """Looks for what the machine reaches into.

        Args:
            machine: the machine.
            ground: a space, and the links whose way it may end.
            placed: where the links are, shape (n_links, 4, 4).
        """
        edge = ground.volume.lattice.edge
        skin, half = skin_of(machine, edge), HALF_DIAGONAL * edge / CELLS
        growth = max(GROWTH_M, GROWTH_IN_VOXELS * edge) + skin.off
        near_m = growth + skin.off + 2 * half
        reached = _shared(machine, ground.volume, placed, (growth + half, near_m + half))
        within = None
        if reached.numbers.size:
            plane = np.zeros_like(ground.volume.words)
            i, j, k = np.array(_indices(reached.numbers, ground.volume.lattice)).T
            np.bitwise_or.at(plane, *bits.places_of(i, j, k, ground.space.grid))
            within = marked(ground.volume._replace(words=plane, shared=reached))
        return cls(ground, within, near_m, placed, reached)._known_in_cells()

    def _known_in_cells(self) -> Self:
        """The same with what is known of voxels cell by cell put into its volumes."""
        reached, parts = self.reached, self.parts
        numbers = np.union1d(reached.numbers, np.fromiter(parts, dtype=np.int64))
        cells = np.full((len(numbers), WORDS), ALL_CELLS)
        links = np.zeros((len(numbers), self.ground.links.size), dtype=np.bool_)
        for row, number in enumerate(numbers.tolist()):
            cells[row] = parts.get(number, ALL_CELLS)
        at = np.searchsorted(numbers, reached.numbers)
        if at.size:
            links[at] = reached.links
        own = reached._replace(cells=reached.cells & cells[at])
        ground = self.ground.volume._replace(shared=Shared(numbers, links, cells, True))
        return replace(
            self,
            ground=replace(self.ground, volume=ground),
            within=None if self.within is None else self.within._replace(shared=own),
        )

    def with_parts(self, free: Mapping[Index, np.uint64]) -> Self:
        """The same with what is known of more voxels.

        Args:
            free: by voxel its free parts, as of `FreeSpace.free_parts`.
        """
        more = {self._number(index): _blocked_cells(parts) for index, parts in free.items()}
        return replace(self, parts={**self.parts, **more})._known_in_cells()

    def is_known(self, index: Index) -> bool:
        """Whether it has been said which parts of a voxel are free.

        Args:
            index: of the voxel.
        """
        return self._number(index) in self.parts

    def unknown_of(self, block: Block) -> list[Index]:
        """Of the voxels that are met where a block is, those of whose parts nothing is known.

        Args:
            block: in one of its volumes.
        """
        lattice = self.ground.volume.lattice
        return [_index(n, lattice) for n in sorted(block.met.tolist()) if n not in self.parts]

    def _number(self, index: Index) -> int:
        lattice = self.ground.volume.lattice
        return (index[0] * lattice.ny + index[1]) * lattice.nz + index[2]

    def holds(self, skin: Skin, speeds: NDArray[np.float64]) -> bool:
        """Whether any of the links that move reaches into blocked space at the start.

        Args:
            skin: of the machine.
            speeds: of its clusters, 0 for those that do not move.
        """
        if self.within is None:
            return False
        some = self.within.shared.cells.any(axis=1)
        return bool(self.within.shared.links[some][:, np.unique(skin.link[speeds > 0])].any())

    def ends(self, machine: Machine, skin: Skin, speeds: NDArray[np.float64], way: Way, before: Ends) -> Ends:
        """The first blocks on a way of the ground's links.

        Args:
            machine, skin: what moves.
            speeds: of its clusters along the way.
            way: where the motion leads.
            before: those before more parts of voxels became free, or `NOT_LOOKED`.
        """
        own = np.where(self.ground.links[skin.link], speeds, 0.0)
        about, within = before
        if about is not None:
            about = find_block(machine, skin, own, way, self.ground.volume, about.asked)
        if within is not None:
            holds = self.within is not None and self.holds(skin, own)
            within = self._end_within(machine, skin, own, way, within.asked) if holds else None
        return Ends(about, within)

    def _end_within(
        self, machine: Machine, skin: Skin, speeds: NDArray[np.float64], way: Way, asked: Asked | None
    ) -> Block | None:
        """The first block of what links reach into, less what may stand within eps of them; or where they press it."""
        assert self.within is not None
        pressed = None if way.stops is not None else self._pressed(machine, skin, speeds, way)
        if pressed is not None:
            way, asked = replace(way, length=pressed.travel), None
        block = find_block(machine, skin, speeds, way, self.within, asked)
        if block is None:
            return pressed
        back = self._back(skin, speeds, way, self.within)
        block = block._replace(travel=max(0.0, block.travel - back))
        # the sweep of a way that was cut short cannot go on
        return block if pressed is None else block._replace(asked=None)

    def _pressed(self, machine: Machine, skin: Skin, speeds: NDArray[np.float64], way: Way) -> Block | None:
        """Where the way ends because links press what they reach into."""
        assert self.within is not None
        shared, lattice = self.within.shared, self.within.lattice
        corners = _corners(shared.numbers, lattice)
        parts = np.array([self._blocked_parts(number) for number in shared.numbers.tolist()], dtype=np.uint64)
        faces = faces_of(machine.shape, checked_rows(machine), skin.off)
        boxes = Boxes(corners, lattice.edge, parts, shared.links)
        found = first_pressed(machine, faces, boxes, way, speeds, skin)
        if found is None:
            return None
        index = _index(int(shared.numbers[found.box]), lattice)
        word, bit = bits.place_of(index, self.ground.space.grid)
        return Block(
            found.travel,
            int(plain(kind_of)(self.within, word, bit)),
            int(np.flatnonzero((skin.link == found.link) & (speeds > 0))[0]),
            corners[found.box] + lattice.edge / 2,
            shared.numbers[[found.box]],
        )

    def _blocked_parts(self, number: int) -> np.uint64:
        """Of a voxel, by its number: one bit for each part that is not known to be free."""
        cells = self.parts.get(number)
        if cells is None:
            return ALL_CELLS
        blocked: np.uint64 = np.packbits(cells != 0, bitorder="little").view(np.uint64)[0]
        return blocked

    def _back(self, skin: Skin, speeds: NDArray[np.float64], way: Way, within: Volume) -> float:
        """How much travel the slowest part that may come to the shared voxels needs for 2 eps."""
        lattice, some = within.lattice, within.shared.cells.any(axis=1)
        centres = _corners(within.shared.numbers, lattice)[some] + lattice.edge / 2
        rows = np.flatnonzero(speeds * way.length >= self.near_m / 2)
        pose = self.placed[skin.link[rows]]
        middles = np.einsum("nij,nj->ni", pose[:, :3, :3], skin.centre[rows]) + pose[:, :3, 3]
        away = np.linalg.norm(middles[:, None] - centres[None], axis=2).min(axis=1)
        reach = skin.radius[rows] + skin.cover + skin.off + speeds[rows] * way.length
        may = rows[away <= reach + HALF_DIAGONAL * lattice.edge]
        return float(2 * self.near_m / speeds[may].min()) if len(may) else 0.0


def _blocked_cells(free: np.uint64) -> Words:
    """The cells of a voxel that lie in no free part of it."""
    is_free = np.unpackbits(np.array([free]).view(np.uint8), bitorder="little").view(np.bool_)
    return np.where(is_free, np.uint64(0), ALL_CELLS)


def _index(number: int, lattice: Lattice) -> Index:
    """Of a voxel's number."""
    return number // lattice.nz // lattice.ny, number // lattice.nz % lattice.ny, number % lattice.nz


def _indices(numbers: NDArray[np.int64], lattice: Lattice) -> list[Index]:
    """Of voxels' numbers."""
    return [_index(number, lattice) for number in numbers.tolist()]


def _corners(numbers: NDArray[np.int64], lattice: Lattice) -> NDArray[np.float64]:
    """The least corners of voxels, by their numbers, shape (n, 3) [m]."""
    index = np.array(_indices(numbers, lattice)).reshape(-1, 3)
    corners: NDArray[np.float64] = index * lattice.edge + (lattice.x0, lattice.y0, lattice.z0)
    return corners


def _shared(
    machine: Machine, volume: Volume, placed: NDArray[np.float64], reach_m: tuple[float, float]
) -> Shared:
    """The blocked voxels that links reach into, and what of them stays blocked.

    Args:
        machine: whose checked links.
        volume: what is blocked.
        placed: where links are.
        reach_m: a cell is covered whose middle is so near to the surface; and links reach into its voxel from which
            it is so near [m].
    """
    skin, lattice = skin_of(machine, volume.lattice.edge), volume.lattice
    finds = np.empty(ROOM_FOR, dtype=np.int64)
    count = reached(placed, skin, skin.cover + reach_m[1], volume, finds)
    numbers = np.unique(finds[: min(count, ROOM_FOR)])
    if not 0 < count <= ROOM_FOR or len(numbers) > MOST_SHARED:
        return volume.shared
    voxels = np.column_stack([_corners(numbers, lattice), np.full(len(numbers), lattice.edge)])
    cells, links = _open_cells(machine, placed, voxels, reach_m)
    is_shared, seen = links.any(axis=1), machine.as_seen
    if seen is not machine:
        # what is covered by what is swept, and not by what is there: something else may be in it
        is_shared &= ~(~cells & _open_cells(seen, placed, voxels, reach_m)[0]).any(axis=1)
    return Shared(numbers[is_shared], links[is_shared], cells[is_shared], False)


def _open_cells(
    machine: Machine, placed: NDArray[np.float64], voxels: NDArray[np.float64], reach_m: tuple[float, float]
) -> tuple[NDArray[np.uint64], NDArray[np.bool_]]:
    """Of some voxels, the cells that the machine does not cover, shape (n, 64), and which links are near.

    Args:
        machine, placed, reach_m: as of `_shared`.
        voxels: their least corners, and their edge, shape (n, 4) [m].
    """
    cells = np.empty((len(voxels), WORDS), dtype=np.uint64)
    links = np.zeros((len(voxels), len(machine.links)), dtype=np.bool_)
    body = pieces(machine, float(voxels[0, 3]))

    def of(some: slice) -> None:
        open_cells(body, placed, voxels[some], reach_m, cells[some], links[some])

    spread(of, [slice(first, first + AT_ONCE) for first in range(0, len(voxels), AT_ONCE)])
    return cells, links
