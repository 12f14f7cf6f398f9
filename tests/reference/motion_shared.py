"""What a body covers of a voxel as plain as can be: the distance of each cell's middle, from trimesh."""

import numpy as np
import trimesh

CELLS = 16


def middles(corner, edge):
    """Of a voxel's cells, (16, 16, 16, 3)."""
    return np.asarray(corner) + (np.moveaxis(np.indices((CELLS,) * 3), 0, -1) + 0.5) * edge / CELLS


def pieces(machine, placed):
    """The parts of a machine's links that hang together, where they are."""
    found = []
    for link, world_from_link in zip(machine.links, placed, strict=True):
        if link.has_geometry:
            whole = trimesh.Trimesh(link.vertices, link.faces)
            whole.apply_transform(world_from_link)
            found += list(whole.split(only_watertight=False))
    return found


def distance(machine, placed, points):
    """Of points (n, 3) from a machine's surface, and whether each lies within a piece of it that is closed."""
    least, within = np.full(len(points), np.inf), np.zeros(len(points), dtype=bool)
    for piece in pieces(machine, placed):
        signed = trimesh.proximity.signed_distance(piece, points)
        least = np.minimum(least, abs(signed))
        within |= (signed > 0) & piece.is_watertight
    return least, within


def triangle_meets(triangle, blocked, corner, edge, grown, box_cuts_triangle):
    """Whether a triangle meets any blocked cell, grown."""
    half = edge / CELLS / 2 + grown
    return any(
        box_cuts_triangle(triangle, middle, half) for middle in middles(corner, edge)[np.asarray(blocked)]
    )


def words_of(cells):
    """The words of a voxel's cells, shape (16, 16, 16): one for each part of 4 x 4 x 4 of them."""
    parts = cells.reshape(4, 4, 4, 4, 4, 4).transpose(0, 2, 4, 1, 3, 5).reshape(-1)
    return np.packbits(parts, bitorder="little").view(np.uint64)
