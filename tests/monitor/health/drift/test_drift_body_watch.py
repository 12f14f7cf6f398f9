"""A machine that is not where its joints say is a fault of its own, and no camera's."""

import numpy as np
import pytest

from elbowroom.machine import Machine
from elbowroom.machine.rasterise import rasterise
from elbowroom.monitor import Watch
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.watch import BODY
from elbowroom.sensing import DepthFrame, Snapshot
from reference import machine_twins
from reference.watch_twins import camera_at, knocked, walls

AT_REST = {"slide": 0.1, "elbow": 0.4, "grip": 0.02}
CAMERAS = (
    camera_at("north", (-0.9, 0.2, 1.3), (0.1, 0.0, 0.5), size=(160, 120)),
    camera_at("east", (0.3, 1.0, 1.2), (0.1, 0.0, 0.5), size=(160, 120)),
    camera_at("south", (1.3, -0.6, 1.4), (0.1, 0.0, 0.5), size=(160, 120)),
)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(machine_twins.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


def frames(arm, cameras, joints, stamp):
    """What cameras see of the arm in the room of six walls, with noise."""
    rng = np.random.default_rng(stamp)
    seen = []
    for camera in cameras:
        depth = np.minimum(walls(camera), rasterise(arm, camera, joints))
        seen.append(DepthFrame(camera.name, stamp, np.float32(depth + rng.normal(0, 0.004, depth.shape))))
    return seen


@pytest.fixture(scope="module")
def references(arm):
    room = Commissioning(CAMERAS, arm, 6)
    for number in range(6):
        room.add(Snapshot.taken(frames(arm, CAMERAS, AT_REST, number), AT_REST))
    return room.references()


def run(arm, references, truly, cameras=CAMERAS, moments=72):
    watch = Watch(CAMERAS, references, arm)
    for k in range(moments):
        health = watch.hear(
            Snapshot.taken(frames(arm, cameras, truly, k * 33_000_000), AT_REST, k * 33_000_000)
        )
    return health


def test_the_machine_is_in_no_reference(arm, references):
    for camera, reference in zip(CAMERAS, references, strict=True):
        assert np.abs(reference.depth_m - walls(camera).ravel()[reference.pixel]).max() < 0.03
        assert not np.isfinite(rasterise(arm, camera, AT_REST)).ravel()[reference.pixel].any()


def test_nothing_happens_where_the_joints_are_right(arm, references):
    health = run(arm, references, AT_REST)
    assert health.reason is None
    assert {link.link for link in health.links} >= {"foot", "upper", "fore"}
    assert all(link.off_m < 0.01 for link in health.links if len(link.cameras) > 1)


def test_a_joint_that_says_too_much_is_a_fault_of_the_machine_and_of_no_camera(arm, references):
    health = run(arm, references, {**AT_REST, "slide": 0.13})
    assert list(health.stops) == [BODY]
    assert "not where its joints say" in health.reason and "cameras see it" in health.reason
    off = [link for link in health.links if link.is_off]
    assert off and off[0].off_m == pytest.approx(0.03, abs=0.012)


def test_a_camera_that_moved_is_the_camera_and_not_the_machine(arm, references):
    truly = (knocked(CAMERAS[0], (0, 1.5, 0)), *CAMERAS[1:])
    assert list(run(arm, references, AT_REST, truly).stops) == ["north"]
