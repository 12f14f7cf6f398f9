"""Where links are, and which voxels a body covers: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry._kernels import bit_of, word_of

FIXED, SLIDES, TURNS = 0, 1, 2


class Tree(NamedTuple):
    """A kinematic tree, a row for each link, parents first; `column`: which joint position moves it, -1 for none."""

    parent: np.ndarray
    parent_from_joint: np.ndarray
    axis: np.ndarray
    kind: np.ndarray
    column: np.ndarray
    multiplier: np.ndarray
    offset: np.ndarray


@njit(cache=True, nogil=True)
def place_links(tree, world_from_base, positions, world_from_link):
    """Forward kinematics: fills world_from_link (n, links, 4, 4) for positions (n, joints)."""
    moved = np.empty((3, 4))
    for n in range(positions.shape[0]):
        for row in range(tree.parent.size):
            parent = tree.parent[row]
            if parent < 0:
                world_from_link[n, row] = world_from_base
                continue
            fixed = tree.parent_from_joint[row]
            if tree.kind[row] == FIXED:
                moved[:] = fixed[:3]
            else:
                position = positions[n, tree.column[row]] * tree.multiplier[row] + tree.offset[row]
                _move(fixed, tree.axis[row], position, tree.kind[row] == SLIDES, moved)
            above = world_from_link[n, parent]
            out = world_from_link[n, row]
            for i in range(3):
                for j in range(4):
                    out[i, j] = above[i, 0] * moved[0, j] + above[i, 1] * moved[1, j] + above[i, 2] * moved[2, j]
                out[i, 3] += above[i, 3]
                out[3, i] = 0.0
            out[3, 3] = 1.0


@njit(inline="always")
def _move(fixed, axis, position, slides, moved):
    """moved = fixed @ (slide along or turn about the axis); Rodrigues' formula for the turn."""
    x, y, z = axis[0], axis[1], axis[2]
    if slides:
        for i in range(3):
            moved[i, :3] = fixed[i, :3]
            moved[i, 3] = fixed[i, 3] + position * (fixed[i, 0] * x + fixed[i, 1] * y + fixed[i, 2] * z)
    else:
        c, s = math.cos(position), math.sin(position)
        d = 1.0 - c
        for i in range(3):
            a, b, e = fixed[i, 0], fixed[i, 1], fixed[i, 2]
            moved[i, 0] = a * (c + x * x * d) + b * (x * y * d + z * s) + e * (x * z * d - y * s)
            moved[i, 1] = a * (x * y * d - z * s) + b * (c + y * y * d) + e * (y * z * d + x * s)
            moved[i, 2] = a * (x * z * d + y * s) + b * (y * z * d - x * s) + e * (c + z * z * d)
            moved[i, 3] = fixed[i, 3]
