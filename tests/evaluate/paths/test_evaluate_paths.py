"""Random paths beside exact geometry: the truth is one, and what is beyond it is noticed."""

from dataclasses import replace
from importlib import metadata
from itertools import islice

import numpy as np
import pytest

from elbowroom.evaluate.cell.cell import ROBOTS
from elbowroom.evaluate.due import due_of
from elbowroom.evaluate.paths.exact import ExactPath
from elbowroom.evaluate.paths.rows import DUE, _along, _beside, path_summary
from elbowroom.evaluate.paths.scenes import path_scenes
from elbowroom.motion import check_path

pytest.importorskip("coal", reason="coal is not installed")


@pytest.fixture(scope="module")
def blocked():
    """The first of some paths of the UR5 that meets something, what is said of it, and its truth."""
    try:
        metadata.distribution(ROBOTS)
    except metadata.PackageNotFoundError:
        pytest.skip(f"{ROBOTS} is not installed")
    for scene in islice(path_scenes("UR5", 0.05, 1), 6):
        exact = ExactPath(scene)
        contact = exact.first_contact()
        if contact is not None:
            return scene, exact, contact
    raise AssertionError("none of the paths meets anything")


def test_at_the_first_contact_something_is_touched_and_before_it_nothing(blocked):
    scene, exact, (time_s, near) = blocked
    assert near.distance_m < 1e-4 and near.link in scene.machine.link_names
    for earlier in np.linspace(0.0, 0.999 * time_s, 20):
        assert scene.truth.nearest(exact.joints(earlier), scene.own, 0.05).distance_m > 0
    # a straight path is SciPy's curve as well
    for at in np.linspace(0, scene.path.end_s, 7):
        assert exact.joints(at) == pytest.approx(scene.joints | scene.path.at(at), abs=2e-5)


def test_what_may_be_followed_ends_before_the_truth_and_what_goes_beyond_it_is_noticed(blocked):
    scene, exact, (time_s, _) = blocked
    rng = np.random.default_rng(0)
    along = check_path(
        scene.space, scene.machine, scene.path, scene.joints, replace(scene.braking, leaves_path=False)
    )
    row = _along(scene, exact, along, rng)
    assert not row["beyond"] and row["shortfall_voxels"] >= 0 and row["true_s"] == time_s
    too_far = replace(along, blocked=replace(along.blocked, time_s=time_s + 0.05))
    assert _along(scene, exact, too_far, rng)["beyond"]
    beside = check_path(scene.space, scene.machine, scene.path, scene.joints, scene.braking)
    assert (beside.follow_until_s or -1.0) <= (along.follow_until_s or -1.0)
    assert not _beside(scene, exact, beside, rng)["beyond"]
    assert _beside(scene, exact, replace(beside, follow_until_s=time_s), rng)["beyond"]


def test_summaries_count_and_unknown_shortfalls_are_great_ones():
    def row(brakes, **more):
        given = {
            "machine": "UR5",
            "brakes": brakes,
            "cause": "surface",
            "follow_until_s": 1.0,
            "beyond": False,
        }
        return given | {"true_s": 1.0, "tried_beyond": True, "shortfall_voxels": 1.0} | more

    rows = [
        row("each joint by itself"),
        row("each joint by itself", shortfall_voxels=2.0),
        row("each joint by itself", true_s=None, shortfall_voxels=None),
        row("each joint by itself", cause="none", true_s=None, tried_beyond=False, shortfall_voxels=None),
        row("along the path", beyond=True, follow_until_s=None),
    ]
    along, beside = path_summary(rows)
    assert (along["beyond"], along["no_prefix"], along["paths"]) == (1, 1, 1)
    assert (beside["compared"], beside["unknown"], beside["free_to_the_end"]) == (3, 1, 1)
    assert beside["median_shortfall_voxels"] == 2.0
    assert not due_of(DUE, "beyond").met(along)
    unknown = [row("each joint by itself", true_s=None, shortfall_voxels=None)] * 2 + rows[:1]
    (most,) = path_summary(unknown)
    assert most["median_shortfall_voxels"] is None
    assert not due_of(DUE, "median_shortfall_voxels").met(most)
