"""Said once at the start: links whose model is larger than what cameras see of them."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.machine.rasterise import rasterise
from elbowroom.monitor.health.model_look import ModelLook
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Snapshot
from reference.contact_machines import joint, link, machine

JOINTS = {"turn": 0.0}
WALL_M = 3.0
FACING = np.array([[0, 0, 1, -2.0], [-1, 0, 0, 0.3], [0, -1, 0, 0.0], [0, 0, 0, 1]])


def arm(folder, thick_m, **more):
    """A bar of 6 cm in a box, seen from one side."""
    return machine(
        folder,
        link("base", (0.1, 0.1, 0.1)),
        link("bar", (thick_m, 0.8, 0.3), (0, 0.5, 0), visual=[((0.06, 0.8, 0.3), (0, 0.5, 0))]),
        joint("turn", "base", "bar"),
        **more,
    )


@pytest.fixture(scope="module")
def camera():
    return DepthCamera("one", 160, 120, FACING, Intrinsics(120, 120, 79.5, 59.5), noise=NOISE_PRESETS["tof"])


def snapshot_of(seen, camera, joints=JOINTS):
    drawn = rasterise(seen, camera, JOINTS)
    depth = np.where(np.isfinite(drawn), drawn, WALL_M)
    depth = depth + np.random.default_rng(0).normal(0, 1, depth.shape) * camera.noise.sigma(depth)
    return Snapshot.taken([DepthFrame("one", 1, depth.astype(np.float32))], joints, None, None)


def test_a_link_that_is_larger_than_it_is_seen_is_named_with_its_excess(tmp_path, camera):
    hull = arm(tmp_path, 0.2, explain_with="collision")
    look = ModelLook([camera], hull)
    assert look.hear(Snapshot.taken([], JOINTS, None, None)) == ()
    (found,) = look.hear(snapshot_of(hull_as_seen(tmp_path), camera))
    assert (found.kind, found.about, found.stops) == ("model", ("bar",), False)
    # the bar's side lies 7 cm within the box
    assert "link bar: model 7" in found.text or "link bar: model 6" in found.text
    assert "explain_with" in found.text and "\n" not in found.text
    # said again, and not looked for again
    assert look.hear(Snapshot.taken([], JOINTS, None, None)) == (found,)


def hull_as_seen(folder):
    return arm(folder, 0.2).as_seen


def test_a_model_that_is_what_is_seen_says_nothing(tmp_path, camera):
    for model in (arm(tmp_path, 0.2), arm(tmp_path, 0.06), arm(tmp_path, 0.2, explain_with="visual")):
        assert ModelLook([camera], model).hear(snapshot_of(model, camera)) == ()


def test_what_stands_before_the_machine_or_behind_it_says_nothing_of_its_size(tmp_path, camera):
    hull = arm(tmp_path, 0.2, explain_with="collision")
    before = Snapshot.taken(
        [DepthFrame("one", 1, np.full((120, 160), 0.8, dtype=np.float32))], JOINTS, None, None
    )
    empty = Snapshot.taken(
        [DepthFrame("one", 1, np.full((120, 160), WALL_M, dtype=np.float32))], JOINTS, None, None
    )
    for snapshot, words in ((before, "sees anything"), (empty, "see through")):
        (found,) = ModelLook([camera], hull).hear(snapshot)
        assert (found.kind, found.stops) == ("machine", False) and words in found.text


def test_cameras_that_begin_later_are_asked_too_and_what_stops_stays(tmp_path, camera):
    """With one camera nothing can be told for sure; that is no reason to ask nobody else."""
    cameras = [replace(camera, name=str(number)) for number in range(5)]
    empty = np.full((120, 160), WALL_M, dtype=np.float32)

    def of(many):
        return Snapshot.taken([DepthFrame(str(n), 1, empty) for n in range(many)], JOINTS, None, None)

    look = ModelLook(cameras, arm(tmp_path, 0.2, explain_with="collision"))
    stops = [[finding.stops for finding in look.hear(of(many))] for many in (0, 1, 1, 5, 1, 0)]
    assert stops == [[], [False], [False], [True], [True], [True]]
    # not at each camera that begins, but at all of them
    look = ModelLook(cameras, arm(tmp_path, 0.2, explain_with="collision"))
    looked = []
    for many in range(6):
        look.hear(replace(of(many), joints=None))
        assert look.found is None
    for many in (1, 3, 4, 5):
        look.found, look._looked = None, max(looked, default=0)
        look.hear(of(many))
        looked += [many] if look.found is not None else []
    assert looked == [1, 3, 5]
