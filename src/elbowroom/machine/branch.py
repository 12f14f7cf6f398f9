"""Links that are added to a tree of links, and those that are taken off it again: what a machine carries."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.kernels.body import FIXED, Tree


def grown(tree: Tree, row: int, link_from_new: NDArray[np.float64]) -> Tree:
    """The tree with one more link, fixed to another.

    Args:
        tree: by link.
        row: of the link that it hangs on.
        link_from_new: where it is on that, shape (4, 4).
    """
    return Tree(
        parent=np.append(tree.parent, row),
        parent_from_joint=np.concatenate([tree.parent_from_joint, link_from_new[None]]),
        axis=np.concatenate([tree.axis, np.zeros((1, 3))]),
        kind=np.append(tree.kind, FIXED),
        column=np.append(tree.column, -1),
        multiplier=np.append(tree.multiplier, 1.0),
        offset=np.append(tree.offset, 0.0),
    )


def stays_without(tree: Tree, row: int) -> NDArray[np.bool_]:
    """Which links stay if one is taken off, and with it those that hang on it.

    Args:
        tree: by link.
        row: of the one.
    """
    stays = np.arange(len(tree.parent)) != row
    for other, parent in enumerate(tree.parent):
        stays[other] &= parent < 0 or stays[parent]
    return stays


def pruned(tree: Tree, stays: NDArray[np.bool_]) -> Tree:
    """The tree of the links that stay.

    Args:
        tree: by link.
        stays: shape (links,); a link that stays hangs on none that does not.
    """
    rows = Tree(*(array[np.flatnonzero(stays)] for array in tree))
    left = np.cumsum(stays) - 1
    return rows._replace(parent=np.where(rows.parent < 0, -1, left[rows.parent]))


class Held(NamedTuple):
    """Links about one that holds something, by row.

    Args:
        fixed: to it, itself among them.
        hanging: on those by a joint, such as fingers.
    """

    fixed: tuple[int, ...]
    hanging: tuple[int, ...]

    @property
    def all(self) -> tuple[int, ...]:
        """Both."""
        return self.fixed + self.hanging


def held_with(tree: Tree, row: int) -> Held:
    """The links that are fixed to a link, and those that hang on them.

    Args:
        tree: by link.
        row: of the link.
    """
    roots = list(range(len(tree.parent)))
    for other, parent in enumerate(tree.parent):
        if parent >= 0 and tree.kind[other] == FIXED:
            roots[other] = roots[parent]
    return Held(
        tuple(other for other, root in enumerate(roots) if root == roots[row]),
        tuple(
            other
            for other, parent in enumerate(tree.parent)
            if parent >= 0 and roots[parent] == roots[row] != roots[other]
        ),
    )
