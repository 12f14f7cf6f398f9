"""What the triangles about some samples meet: exact but for their movement within an interval."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.motion.kernels.mover import ROUNDING_M, Skin, carried
from elbowroom.motion.kernels.shared import row_of, triangle_meets_cells
from elbowroom.motion.kernels.triangles import triangle_meets_box
from elbowroom.motion.kernels.volume import cell_of, counted, gap, leaves

SURFACE, OUTSIDE, BLIND, UNSEEN, NOTHING = 0, 1, 2, 3, 4
"""What a block is, the most cautious first."""


class Patch(NamedTuple):
    """The triangles about a sample: where its link is, which link it is, by how much they are grown [m], of which skin
    and sample."""

    world_from_link: np.ndarray
    link: int
    grown: float
    skin: Skin
    sample: int


@uncounted()
def _leaves_patch(patch, lattice):
    """Whether a corner of a patch, grown, leaves the grid."""
    skin = patch.skin
    for n in range(skin.patch_start[patch.sample], skin.patch_start[patch.sample + 1]):
        for corner in range(3):
            x, y, z = carried(patch.world_from_link, skin.triangles[skin.patches[n], corner])
            if leaves(x, y, z, patch.grown, lattice):
                return True
    return False


@uncounted()
def _meets_patch(patch, x, y, z, half_edge, triangle):
    """Whether a patch, as it is, meets a cube; `triangle` (3, 3) is room to work in."""
    skin = patch.skin
    for n in range(skin.patch_start[patch.sample], skin.patch_start[patch.sample + 1]):
        for corner in range(3):
            a, b, c = carried(patch.world_from_link, skin.triangles[skin.patches[n], corner])
            triangle[corner, 0], triangle[corner, 1], triangle[corner, 2] = a, b, c
        if triangle_meets_box(triangle, x, y, z, half_edge):
            return True
    return False


@uncounted()
def _meets_shared(patch, row, volume, x, y, z, triangle):
    """Whether a patch, as it is grown, meets the blocked cells of a voxel about (x, y, z)."""
    skin, edge = patch.skin, volume.lattice.edge
    for n in range(skin.patch_start[patch.sample], skin.patch_start[patch.sample + 1]):
        for corner in range(3):
            a, b, c = carried(patch.world_from_link, skin.triangles[skin.patches[n], corner])
            triangle[corner, 0], triangle[corner, 1], triangle[corner, 2] = a, b, c
        if triangle_meets_cells(
            triangle, volume.shared.cells[row], x - edge / 2, y - edge / 2, z - edge / 2, edge, patch.grown
        ):
            return True
    return False


@njit(inline="always")
def kind_of(volume, word, bit):
    """What a blocked voxel is."""
    if volume.surface[word] & bit:
        return SURFACE
    if volume.blind[word] & bit:
        return BLIND
    if volume.disputed[word] & bit:
        return SURFACE
    return UNSEEN


@uncounted()
def touched_block(placed, mover, half, volume, samples, place, triangle):
    """The most cautious block that samples' patches meet, grown by their movement: what, by which cluster.

    Exact but for that growth: triangles against voxels. Fills `place` (3,) with the voxel's centre, or the
    sample whose patch leaves the grid [m]; `triangle` (3, 3) is room to work in.
    """
    skin, lattice = mover.skin, volume.lattice
    found, by = NOTHING, -1
    for sample in samples:
        cluster = skin.cluster_of[sample]
        world_from_link = placed[skin.link[cluster]]
        x, y, z = carried(world_from_link, skin.points[sample])
        grown = mover.speeds[cluster] * half + (ROUNDING_M + skin.off)
        patch = Patch(world_from_link, skin.link[cluster], grown, skin, sample)
        r = skin.cover + grown
        if volume.shared.others and leaves(x, y, z, r, lattice) and _leaves_patch(patch, lattice):
            if found > OUTSIDE:
                found, by = OUTSIDE, cluster
                place[0], place[1], place[2] = x, y, z
            continue
        kind = _touched_by(patch, counted(x, y, z, r, lattice), volume, found, place, triangle)
        if kind < found:
            found, by = kind, cluster
        if found == SURFACE:
            break
    return found, by


@uncounted()
def _touched_by(patch, ball, volume, found, place, triangle):
    """The most cautious block that a patch meets, if it is more cautious than what was found; else that.

    Args:
        ball: about the patch, centre and radius counted in voxels.
        place: (3,), written where there is such a block: its centre [m].
        triangle: (3, 3), room to work in.
    """
    lattice = volume.lattice
    u, v, w, s = ball
    for i in range(cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx) + 1):
        du = gap(u, i * 1.0, i + 1.0)
        for j in range(cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny) + 1):
            dv = gap(v, j * 1.0, j + 1.0)
            for k in range(cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz) + 1):
                dw = gap(w, k * 1.0, k + 1.0)
                word, bit = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z), bit_of(i, j, k)
                if not volume.words[word] & bit or du * du + dv * dv + dw * dw > s * s:
                    continue
                kind = kind_of(volume, word, bit)
                if kind >= found:
                    continue
                if _meets_voxel(patch, i, j, k, volume, triangle):
                    found = kind
                    place[0] = lattice.x0 + (i + 0.5) * lattice.edge
                    place[1] = lattice.y0 + (j + 0.5) * lattice.edge
                    place[2] = lattice.z0 + (k + 0.5) * lattice.edge
    return found


@uncounted()
def _meets_voxel(patch, i, j, k, volume, triangle):
    """Whether a patch, as it is grown, meets what is blocked of a blocked voxel."""
    lattice, shared = volume.lattice, volume.shared
    x, y, z = (
        lattice.x0 + (i + 0.5) * lattice.edge,
        lattice.y0 + (j + 0.5) * lattice.edge,
        lattice.z0 + (k + 0.5) * lattice.edge,
    )
    row = row_of(shared, (i * lattice.ny + j) * lattice.nz + k)
    if row < 0:
        return shared.others and _meets_patch(patch, x, y, z, lattice.edge / 2 + patch.grown, triangle)
    if shared.links[row, patch.link] == shared.others:
        return False
    return _meets_shared(patch, row, volume, x, y, z, triangle)


@uncounted()
def list_touched(placed, mover, half, volume, samples, triangle, numbers):
    """The blocked voxels that samples' patches meet, as of `touched_block`; how many are written.

    Args:
        placed, mover, half, volume, samples, triangle: as of `touched_block`.
        numbers: takes their numbers, (i ny + j) nz + k, as many as there is room for, each once.
    """
    skin, lattice = mover.skin, volume.lattice
    count = 0
    for sample in samples:
        cluster = skin.cluster_of[sample]
        world_from_link = placed[skin.link[cluster]]
        x, y, z = carried(world_from_link, skin.points[sample])
        grown = mover.speeds[cluster] * half + (ROUNDING_M + skin.off)
        patch = Patch(world_from_link, skin.link[cluster], grown, skin, sample)
        u, v, w, s = counted(x, y, z, skin.cover + grown, lattice)
        for i in range(cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx) + 1):
            du = gap(u, i * 1.0, i + 1.0)
            for j in range(cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny) + 1):
                dv = gap(v, j * 1.0, j + 1.0)
                for k in range(cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz) + 1):
                    dw = gap(w, k * 1.0, k + 1.0)
                    word, bit = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z), bit_of(i, j, k)
                    if not volume.words[word] & bit or du * du + dv * dv + dw * dw > s * s:
                        continue
                    number = (i * lattice.ny + j) * lattice.nz + k
                    if _is_among(number, numbers, count) or not _meets_voxel(
                        patch, i, j, k, volume, triangle
                    ):
                        continue
                    if count == numbers.size:
                        return count
                    numbers[count] = number
                    count += 1
    return count


@njit(inline="always")
def _is_among(number, numbers, count):
    """Whether a number is one of the first few."""
    found = False
    for n in range(count):
        found |= numbers[n] == number
    return found
