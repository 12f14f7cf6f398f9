"""Optimising by motions: what each is worth, and that a layout found by it stops fewer for nothing."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from elbowroom.errors import InputError
from elbowroom.placement import Goal
from elbowroom.placement.in_use import optimise_in_use
from elbowroom.placement.rehearsal import Settings
from elbowroom.placement.solver.scene_layout import SceneLayout, SceneModel
from elbowroom.placement.solver.swept_layout import FEW, SweptModel

FEW_EXAMPLES = settings(derandomize=True, max_examples=25)


def model_of(rng, candidates=5, motions=4):
    lengths = rng.integers(1, 4, motions)
    words = int(lengths.sum())
    draw = lambda *shape: rng.integers(0, 2**63, shape, dtype=np.uint64)  # noqa: E731
    through, truly = draw(candidates, words), draw(words)
    disputed = draw(candidates, words) & draw(candidates, words) & ~through
    start = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    points = int(np.bitwise_count(truly).sum())
    common = (through, disputed, truly, points, np.arange(candidates), np.ones(candidates), ())
    return SweptModel(*common, start, rng.uniform(0.2, 1.0, motions)), SceneModel(*common)


def plainly(model, chosen):
    """Bit by bit: worth of each motion by what is not found of it."""
    total = 0.0
    for m, weight in enumerate(model.weight):
        missing = 0
        for word in range(model.start[m], model.start[m + 1]):
            for bit in range(64):
                on = lambda plane: bool(int(plane) >> bit & 1)  # noqa: B023, E731
                seen = sum(on(model.through[c, word]) for c in chosen)
                disputed = any(on(model.disputed[c, word]) for c in chosen)
                found = seen >= 3 or (seen >= 1 and not disputed)
                missing += on(model.truly[word]) and not found
        total += weight * FEW / (FEW + missing)
    return total


@FEW_EXAMPLES
@given(seed=some.integers(0, 10**6), count=some.integers(0, 4))
def test_a_layout_is_worth_what_bits_say_one_by_one(seed, count):
    rng = np.random.default_rng(seed)
    model, _ = model_of(rng)
    chosen = list(rng.permutation(model.candidates)[:count])
    layout = model.empty()
    for candidate in chosen:
        gain = layout.gains()[candidate]
        before = layout.valid
        layout.add(int(candidate))
        assert layout.valid - before == pytest.approx(gain)
    assert layout.valid == pytest.approx(plainly(model, chosen))
    assert layout.share <= model.share_bound + 1e-12 <= 1 + 1e-12
    assert layout.without(layout.chosen[:1]).valid == pytest.approx(plainly(model, chosen[1:]))


def test_a_model_of_scenes_keeps_its_own_layout():
    _, scenes = model_of(np.random.default_rng(1))
    assert type(scenes.empty()) is SceneLayout and type(scenes.empty().without([])) is SceneLayout


def test_without_a_machine_there_are_no_motions_to_place_cameras_for():
    from elbowroom.geometry import VoxelGrid

    grid = VoxelGrid.covering((-1, -1, 0), (1, 1, 1), 0.2)
    with pytest.raises(InputError, match="no machine with speeds of its joints"):
        optimise_in_use([], [object()], Settings(grid), Goal(cameras=2, by_motions=True))
