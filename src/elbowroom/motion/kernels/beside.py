"""Boxes of joint positions: whether the machine meets anything at any of them, all joints moving by themselves.

A box is looked at in its middle, all balls grown by the most that they are elsewhere in the box. Where none meets a
block the box is free; so it is where no cluster and no triangle about a sample does, as far as joints carry them to and
fro (`sway`). Else it is cut in half, along the joint that moves what is left the most, until no point moves
farther than `Cutting.finest`. So the answer errs on the side of blocked alone.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.machine.kernels.apart import Asked, relate, soonest
from elbowroom.machine.kernels.body import FIXED, SLIDES, place_links
from elbowroom.motion.kernels.closing import space
from elbowroom.motion.kernels.meeting import gap_of
from elbowroom.motion.kernels.mover import Course, Mover, Skin, carried, distance_to_axis
from elbowroom.motion.kernels.near import TOGETHER, near_boxes, near_members
from elbowroom.motion.kernels.sway import first_unclear
from elbowroom.motion.kernels.touched import NOTHING, touched_block
from elbowroom.motion.kernels.volume import Volume

DEPTH = 128
"""No box is cut more often."""
SAMPLES_BELOW = 1.0
"""From a growth of so little on single samples are asked [voxel edges]."""


class Box(NamedTuple):
    """Joint positions no farther from the middle than half, joint by joint, (joints,) each [m or rad]."""

    middle: np.ndarray
    half: np.ndarray


class Cutting(NamedTuple):
    """How closely boxes are looked at: nothing is cut in which no point moves farther than `finest` [m], and no more
    than `most` boxes are looked at; then what is left counts as blocked."""

    finest: float
    most: int


class Cuts(NamedTuple):
    """Boxes that are being cut, a row a depth: middle and half of each, which half of its parent comes next, and along
    which joint it is cut."""

    middle: np.ndarray
    half: np.ndarray
    done: np.ndarray
    joint: np.ndarray


@njit
def _cuts(box):
    """The box itself in row 0, and room for its parts."""
    joints = box.middle.size
    cuts = Cuts(
        np.empty((DEPTH + 1, joints)),
        np.empty((DEPTH + 1, joints)),
        np.zeros(DEPTH + 1, dtype=np.int64),
        np.full(DEPTH + 1, -1),
    )
    cuts.middle[0, :], cuts.half[0, :] = box.middle, box.half
    return cuts


@njit
def _next(cuts, depth):
    """Makes the next box to look at after the one at a depth is done; its depth, -1 for none."""
    depth -= 1
    while depth >= 0:
        if cuts.done[depth] == 1:
            return _half_of(cuts, depth)
        depth -= 1
    return -1


@njit
def _half_of(cuts, depth):
    """Makes the next half of the box at a depth; its depth."""
    joint = cuts.joint[depth]
    cuts.middle[depth + 1, :], cuts.half[depth + 1, :] = cuts.middle[depth], cuts.half[depth]
    quarter = cuts.half[depth, joint] / 2
    cuts.half[depth + 1, joint] = quarter
    cuts.middle[depth + 1, joint] += quarter if cuts.done[depth] == 1 else -quarter
    cuts.done[depth] += 1
    return depth + 1


@njit
def _cut(cuts, depth, joint):
    """Cuts the box at a depth along a joint, and makes its first half; its depth."""
    cuts.done[depth], cuts.joint[depth] = 0, joint
    return _half_of(cuts, depth)


@njit
def moves(tree, placed, half, rows, place, size, by_joint):
    """The most that any point of a ball can be elsewhere in a box than in its middle.

    Joints are turned one after another, those farthest from the base first. So those above a joint stand still as it
    turns, and its axis with them; and the ball is no farther from it than it was, and what it was moved by before.

    Args:
        tree: of the machine.
        placed: where links are in the middle, (links, 4, 4).
        half: of the box, (joints,).
        rows: of the ball's link, and of the link up the tree against which it moves; -1: against the world.
        place: the ball's middle, world frame.
        size: its radius [m].
        by_joint: (joints,), takes what each joint does [m].
    """
    row, top = rows
    x, y, z = place
    by_joint[:] = 0.0
    moved = 0.0
    while row >= 0 and row != top:
        column = tree.column[row]
        if tree.kind[row] != FIXED and half[column] > 0.0:
            turn = half[column] * abs(tree.multiplier[row])
            if tree.kind[row] != SLIDES:
                turn *= distance_to_axis(placed[row], tree.axis[row], x, y, z) + size + moved
            by_joint[column] += turn
            moved += turn
        row = tree.parent[row]
    return moved


@njit(cache=True, nogil=True)
def block_in_box(tree, world_from_base, skin, box, volume, asked, cutting):
    """The first block found that the machine meets at any joint positions of a box.

    Args:
        tree, world_from_base, skin: what moves, as of `Mover`.
        box: of its joint positions.
        volume: what is blocked.
        asked: clusters of the skin, int32.
        cutting: how closely it is looked at.

    Returns:
        What the block is, NOTHING for none; the cluster that meets it, and where (3,) [m].
    """
    cuts, counts = _cuts(box), np.zeros(DEPTH + 2, dtype=np.int64)
    clusters = np.empty((DEPTH + 2, asked.size), dtype=np.int32)
    clusters[0, :], counts[0] = asked, asked.size
    total = 0
    for cluster in asked:
        total += skin.stop[cluster] - skin.start[cluster]
    samples, corners = np.empty(total, dtype=np.int32), np.empty((3, TOGETHER), dtype=np.int32)
    course = Course(np.zeros(1), np.zeros((1, box.middle.size)))
    mover = Mover(tree, world_from_base, skin, course, np.zeros(skin.link.size))
    placed, place = np.empty((1, tree.parent.size, 4, 4)), np.zeros(3)
    triangle, by_joint = np.empty((3, 3)), np.zeros(box.middle.size)
    ways, unclear = np.empty((tree.parent.size, 3)), np.full(1, -1, dtype=np.int32)
    depth, looks = 0, 0
    while depth >= 0:
        looks += 1
        place_links(tree, world_from_base, cuts.middle[depth : depth + 1], placed)
        near, half = clusters[depth + 1], cuts.half[depth]
        left = near_boxes(placed[0], mover, half, 0.0, volume, clusters[depth, : counts[depth]], near, ways)
        _grow(mover, placed[0], half, near[:left], by_joint)
        growth, fastest = _most(mover.speeds, near[:left])
        many = 0
        if left > 0 and growth <= SAMPLES_BELOW * volume.lattice.edge:
            many = near_members(placed[0], mover, 1.0, volume, near[:left], samples, corners)
            left = _members(skin, samples[:many], near)
            growth, fastest = _most(mover.speeds, near[:left])
            if growth > cutting.finest:
                sways = Sways(mover, placed[0], half, volume, ways, triangle)
                left = 0 if _are_clear(sways, samples[:many], unclear) else left
        counts[depth + 1] = left
        if left == 0:
            depth = _next(cuts, depth)
            continue
        last = growth <= cutting.finest or depth == DEPTH or looks >= cutting.most
        if not last:
            joint = _along(mover, placed[0], half, fastest, by_joint)
            depth = _cut(cuts, depth, joint)
            continue
        if many == 0:
            many = near_members(placed[0], mover, 1.0, volume, near[:left], samples, corners)
        kind, by = touched_block(placed[0], mover, 1.0, volume, samples[:many], place, triangle)
        if kind != NOTHING:
            return kind, by, place
        depth = _next(cuts, depth)
    return NOTHING, -1, place


@njit(cache=True, nogil=True)
def near_in_box(tree, world_from_base, skin, box, volume, asked):
    """The clusters of a skin that may meet a block somewhere in a box, int32; others meet none in any part of it.

    Args:
        tree, world_from_base, skin, box, volume, asked: as of `block_in_box`.
    """
    placed, ways = np.empty((1, tree.parent.size, 4, 4)), np.empty((tree.parent.size, 3))
    course = Course(np.zeros(1), np.zeros((1, box.middle.size)))
    mover = Mover(tree, world_from_base, skin, course, np.zeros(skin.link.size))
    near = np.empty(asked.size, dtype=np.int32)
    place_links(tree, world_from_base, box.middle.reshape(1, -1), placed)
    left = near_boxes(placed[0], mover, box.half, 0.0, volume, asked, near, ways)
    return near[:left]


class Sways(NamedTuple):
    """What is asked of samples in one box: the arguments of `first_unclear` beside them, and (3, 3) to work in."""

    mover: Mover
    placed: np.ndarray
    half: np.ndarray
    volume: Volume
    ways: np.ndarray
    triangle: np.ndarray


@njit
def _are_clear(sways, samples, unclear):
    """Whether no patch of some samples may meet a block in a box.

    The one that was not clear before is asked first: `unclear` (1,), -1 for none, written.
    """
    room = sways.ways, sways.triangle
    if (
        unclear[0] >= 0
        and first_unclear(sways.placed, sways.mover, sways.half, sways.volume, unclear, room) >= 0
    ):
        return False
    unclear[0] = first_unclear(sways.placed, sways.mover, sways.half, sways.volume, samples, room)
    return unclear[0] < 0


@njit
def _grow(mover, placed, half, clusters, by_joint):
    """Writes, for some clusters, how much they move in a box where a mover has their speeds."""
    skin = mover.skin
    for cluster in clusters:
        row, size = skin.link[cluster], skin.radius[cluster] + skin.cover
        place = carried(placed[row], skin.centre[cluster])
        mover.speeds[cluster] = moves(mover.tree, placed, half, (row, -1), place, size, by_joint)


@njit
def _along(mover, placed, half, cluster, by_joint):
    """The joint that moves a cluster the most."""
    skin = mover.skin
    row, size = skin.link[cluster], skin.radius[cluster] + skin.cover
    moves(mover.tree, placed, half, (row, -1), carried(placed[row], skin.centre[cluster]), size, by_joint)
    return np.argmax(by_joint)


@njit
def _most(speeds, clusters):
    """The greatest speed of some clusters, and which has it; 0 and -1 for none."""
    most, which = 0.0, -1
    for cluster in clusters:
        if speeds[cluster] >= most:
            most, which = speeds[cluster], cluster
    return most, which


@uncounted()
def _members(skin, samples, clusters):
    """Writes the clusters of some samples, which lie together; how many."""
    count = 0
    for sample in samples:
        cluster = skin.cluster_of[sample]
        if count == 0 or clusters[count - 1] != cluster:
            clusters[count] = cluster
            count += 1
    return count


class Closing(NamedTuple):
    """One pair of links in a box.

    Fields:
        pair: of the pairs that must not meet.
        top: the link up the tree that both hang on, against which they move; -1: none.
        parts: the parts of the links, as a skin.
        floor: of links that lie in each other, how deep samples say that they may [m].
        met: links that are apart have met when they are so near; 0: they lie in each other where they stand [m].
    """

    pair: int
    top: int
    parts: Skin
    floor: float
    met: float


@njit(cache=True, nogil=True)
def pair_in_box(tree, world_from_base, pairs, closing, box, cutting, place):
    """Whether two links meet at any joint positions of a box, by the laws of `first_meeting`.

    Args:
        tree, world_from_base: of the machine.
        pairs: what must not meet.
        closing: which of them (`Closing`).
        box: of joint positions; joints that do not move the two against each other should have none.
        cutting: how closely it is looked at.
        place: (3,), takes where they meet [m].
    """
    bodies, parts, pair = pairs.bodies, closing.parts, closing.pair
    one, other = bodies.one[pair], bodies.other[pair]
    cuts, work, by_joint = _cuts(box), space(tree.parent.size), np.zeros(box.middle.size)
    most_by_joint, speeds, depth, looks = np.zeros(box.middle.size), np.zeros(parts.link.size), 0, 0
    while depth >= 0:
        looks += 1
        place_links(tree, world_from_base, cuts.middle[depth : depth + 1], work.placed)
        placed, half = work.placed[0], cuts.half[depth]
        growth = 0.0
        for part in range(parts.link.size):
            row = parts.link[part]
            if row in (one, other):
                centre = carried(placed[row], parts.centre[part])
                speeds[part] = moves(
                    tree, placed, half, (row, closing.top), centre, parts.radius[part], by_joint
                )
                if speeds[part] >= growth:
                    growth = speeds[part]
                    most_by_joint[:] = by_joint
        if closing.met > 0.0:
            relate(placed, one, other, work.other_from_one)
            work.room.last[0] = -1
            asked = Asked(closing.met / 2, closing.met, 1.0)
            when = soonest(bodies.boxes, (one, other), work.other_from_one, speeds, asked, work.room)
            is_clear = when >= 1.0
        else:
            is_clear = _stay_up(tree, pairs, closing, placed, half, by_joint)
        if is_clear:
            depth = _next(cuts, depth)
        elif growth <= cutting.finest or depth == DEPTH or looks >= cutting.most:
            x, y, z = _between(parts, placed, one)
            place[0], place[1], place[2] = x, y, z
            return True
        else:
            depth = _cut(cuts, depth, np.argmax(most_by_joint))
    return False


@njit
def _stay_up(tree, pairs, closing, placed, half, by_joint):
    """Whether links that lie in each other get no deeper than they may, by samples of one in the field of the other."""
    skin, pair = pairs.skin, closing.pair
    row, other = pairs.sampled[pair], pairs.other[pair]
    other_from_one, nearest = np.empty((3, 4)), np.zeros(1, dtype=np.int64)
    relate(placed, row, other, other_from_one)
    beyond = 0.0
    for part in range(closing.parts.link.size):
        if closing.parts.link[part] == other:
            centre, size = carried(placed[other], closing.parts.centre[part]), closing.parts.radius[part]
            moved = moves(tree, placed, half, (other, closing.top), centre, size, by_joint)
            beyond = max(beyond, moved)
    for member in range(pairs.pair.size):
        if pairs.pair[member] != pair:
            continue
        cluster = pairs.cluster[member]
        centre, size = carried(placed[row], skin.centre[cluster]), skin.radius[cluster] + skin.cover
        moved = moves(tree, placed, half, (row, closing.top), centre, size, by_joint) + beyond
        if gap_of(pairs, member, other_from_one, closing.floor, nearest) - closing.floor <= moved:
            return False
    return True


@njit
def _between(parts, placed, row):
    """A place on a link: the middle of its first part."""
    for part in range(parts.link.size):
        if parts.link[part] == row:
            return carried(placed[row], parts.centre[part])
    return placed[row, 0, 3], placed[row, 1, 3], placed[row, 2, 3]
