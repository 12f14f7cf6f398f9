"""Links are added to a tree of links and taken off it; the others stay where they are."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.machine.branch import grown, held_with, pruned, stays_without
from elbowroom.machine.kernels.body import FIXED, Tree

TURNS = FIXED + 1


@st.composite
def trees(draw):
    """Up to eight links, each on an earlier one, fixed or not."""
    count = draw(st.integers(1, 8))
    parent = np.array([-1] + [draw(st.integers(0, n - 1)) for n in range(1, count)])
    fixed = np.array([draw(st.booleans()) for _ in range(count)])
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, 0, 3] = np.arange(count)
    return Tree(
        parent=parent,
        parent_from_joint=poses,
        axis=np.tile((0.0, 0.0, 1.0), (count, 1)),
        kind=np.where(fixed, FIXED, TURNS),
        column=np.where(fixed, -1, np.arange(count)),
        multiplier=np.ones(count),
        offset=np.zeros(count),
    )


def same(one, other):
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


@settings(max_examples=60)
@given(trees(), st.data())
def test_a_link_that_is_added_and_taken_off_leaves_the_tree_as_it_was(tree, data):
    row = data.draw(st.integers(0, len(tree.parent) - 1))
    more = grown(tree, row, 2 * np.eye(4))
    new = len(tree.parent)
    assert more.parent[new] == row and more.kind[new] == FIXED
    stays = stays_without(more, new)
    assert stays.sum() == new and not stays[new]
    assert same(pruned(more, stays), tree)


@settings(max_examples=60)
@given(trees(), st.data())
def test_whatever_hangs_on_a_link_goes_with_it_and_nothing_else(tree, data):
    row = data.draw(st.integers(0, len(tree.parent) - 1))
    stays = stays_without(tree, row)
    for link in range(len(tree.parent)):
        way = [link]
        while tree.parent[way[-1]] >= 0:
            way.append(tree.parent[way[-1]])
        assert stays[link] == (row not in way)
    left = pruned(tree, stays)
    assert np.array_equal(left.parent_from_joint[:, 0, 3], np.flatnonzero(stays))
    for link, parent in zip(np.flatnonzero(stays), left.parent, strict=True):
        assert (
            tree.parent[link] if tree.parent[link] < 0 else np.cumsum(stays)[tree.parent[link]] - 1
        ) == parent


@settings(max_examples=60)
@given(trees(), st.data())
def test_what_holds_a_part_is_what_is_fixed_to_its_link_and_about_it_what_hangs_on_that(tree, data):
    row = data.draw(st.integers(0, len(tree.parent) - 1))
    held = held_with(tree, row)
    assert row in held.fixed and not set(held.fixed) & set(held.hanging)
    fixed = {(int(p), n) for n, p in enumerate(tree.parent) if p >= 0 and tree.kind[n] == FIXED}
    body, grew = {row}, True
    while grew:
        more = {n for pair in fixed if body & set(pair) for n in pair}
        grew, body = not more <= body, body | more
    hangs = {n for n, p in enumerate(tree.parent) if p >= 0 and int(p) in body}
    assert set(held.fixed) == body and set(held.hanging) == hangs - body
