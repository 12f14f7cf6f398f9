"""The triangles of a machine's links in trees of boxes, for exact distances."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.geometry.parallel import spread
from elbowroom.machine.kernels.boxes import Boxes, cut
from elbowroom.machine.link import Link
from elbowroom.machine.shape import Shape

PART_DEPTH = 4
"""A link is cut into parts, each with a speed of its own, at this depth of its tree: 16 at most, and those above."""


@kept
def boxes_of(shape: Shape) -> Boxes:
    """The triangles of all links of a shape in trees of boxes; of fine links, too, all of them."""
    trees = spread(_tree, shape.links)
    boxes = np.cumsum([0, *(len(tree.centre) for tree in trees)])
    triangles = np.cumsum([0, *(len(tree.triangles) for tree in trees)])
    parts = np.cumsum([0, *(int(tree.part.max(initial=-1)) + 1 for tree in trees)])
    return Boxes(
        triangles=np.concatenate([tree.triangles for tree in trees]),
        centre=np.concatenate([tree.centre for tree in trees]),
        half=np.concatenate([tree.half for tree in trees]),
        child=np.concatenate(
            [np.where(tree.child < 0, -1, tree.child + n) for tree, n in zip(trees, boxes, strict=False)]
        ),
        first=np.concatenate([tree.first + n for tree, n in zip(trees, triangles, strict=False)]),
        stop=np.concatenate([tree.stop + n for tree, n in zip(trees, triangles, strict=False)]),
        part=np.concatenate([tree.part + n for tree, n in zip(trees, parts, strict=False)]),
        link=np.repeat(np.arange(len(trees)), [len(tree.centre) for tree in trees]),
        root=np.array(
            [n if len(tree.centre) else -1 for tree, n in zip(trees, boxes, strict=False)], dtype=np.int32
        ),
    )


@kept
def _tree(link: Link) -> Boxes:
    """The tree of one link alone; its parts are numbered from 0."""
    count = len(link.faces)
    order = np.empty(count, dtype=np.int64)
    most = 2 * max(count, 1)
    centre, half = np.zeros((most, 3)), np.zeros((most, 3))
    child, first, stop = (np.zeros(most, dtype=np.int32) for _ in range(3))
    triangles = np.ascontiguousarray(link.triangles)
    made = cut(triangles, order, centre, half, child, first, stop) if count else 0
    child = child[:made]
    return Boxes(
        triangles=triangles[order],
        centre=centre[:made],
        half=half[:made],
        child=child,
        first=first[:made],
        stop=stop[:made],
        part=_parts(child),
        link=np.zeros(made, dtype=np.int32),
        root=np.zeros(1 if made else 0, dtype=np.int32),
    )


def _parts(child: NDArray[np.int32]) -> NDArray[np.int32]:
    """The part of each box: that of the box at `PART_DEPTH` that it lies in; boxes above it are parts as well."""
    part, depth = np.zeros(len(child), dtype=np.int32), np.zeros(len(child), dtype=np.int32)
    count = 1
    for box, begun in enumerate(child):
        if begun < 0:
            continue
        for one in (begun, begun + 1):
            depth[one] = depth[box] + 1
            if depth[one] <= PART_DEPTH:
                part[one] = count
                count += 1
            else:
                part[one] = part[box]
    return part
