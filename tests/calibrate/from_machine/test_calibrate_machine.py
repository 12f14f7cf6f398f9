import importlib.metadata
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from elbowroom.calibrate.from_machine.target import calibrate_from_machine
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.geometry.twist import between, moved, sizes
from elbowroom.machine import Machine
from elbowroom.sensing import NOISE_PRESETS, Snapshot
from elbowroom.simulate import Moment, render
from elbowroom.simulate.machine_solids import link_solids, random_joints
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Solid
from reference.calibrate_machines import camera, cameras, errors, poses_of, record, room, roughly

FAR_OUT = chi2.ppf(0.9999, 6)
"""A truth farther off than this is not what an honest covariance says, once in ten thousand cameras."""


@pytest.fixture(scope="module")
def busy():
    """The room with people who walk from pose to pose, eight poses, three noisy cameras."""
    place, true = room(), cameras()
    return place.machine, true, record(true, poses_of(place, 8))


@pytest.fixture(scope="module")
def found(busy):
    machine, true, moments = busy
    return calibrate_from_machine(machine, roughly(true, 1), moments)


def test_noisy_cameras_in_a_room_with_people_are_found_from_10_cm_and_5_degrees_off(busy, found):
    for metres, degrees, square in errors(found.cameras, busy[1]).values():
        assert metres < 0.004
        assert degrees < 0.1
        assert square < FAR_OUT
    assert [one.camera.name for one in found.cameras] == [one.name for one in busy[1]]


def test_without_noise_the_truth_is_recovered():
    place = room(people=False)
    true = cameras(noise=None, width=240)
    result = calibrate_from_machine(place.machine, roughly(true, 2), record(true, poses_of(place, 6)))
    for metres, degrees, _ in errors(result.cameras, true).values():
        assert metres < 5e-4
        assert degrees < 0.01


def test_order_of_cameras_and_poses_does_not_matter(busy, found):
    machine, true, moments = busy
    turned = calibrate_from_machine(machine, roughly(true, 1)[::-1], moments[::-1])
    straight = {one.camera.name: one.camera.world_from_camera for one in found.cameras}
    for one in turned.cameras:
        metres, radians = sizes(between(straight[one.camera.name], one.camera.world_from_camera))
        # ways differ, and end within a share of a sigma
        assert metres < 2e-4
        assert radians < 2e-4


def test_where_the_base_is_follows_from_cameras_that_hold(busy):
    machine, true, moments = busy
    off = moved(machine.world_from_base, np.array([0.03, -0.02, 0.05, 0.04, 0.05, -0.03]))
    known, north_sure = np.diag([1e-8] * 3 + [1e-7] * 3), roughly(true, 4)
    given = [true[0], true[1], north_sure[2]]
    result = calibrate_from_machine(
        replace(machine, world_from_base=off),
        given,
        moments,
        hold={"north": None, "east": known},
        free_base=True,
    )
    twist = between(result.machine.world_from_base, machine.world_from_base)
    metres, radians = sizes(twist)
    assert metres < 0.003
    assert np.degrees(radians) < 0.1
    assert twist @ np.linalg.solve(result.base_covariance, twist) < FAR_OUT
    assert {one.camera.name for one in result.cameras} == {"east", "west"}
    for metres, degrees, square in errors(result.cameras, true).values():
        assert metres < 0.005
        assert degrees < 0.1
        assert square < FAR_OUT


def test_depth_that_reads_too_far_does_not_move_the_camera():
    place, true = room(people=False), cameras()[:1]
    moments = [
        replace(
            moment,
            frames=tuple(replace(f, depth_m=f.depth_m * np.float32(1.004) + np.float32(0.006)) for f in moment.frames),
        )
        for moment in record(true, poses_of(place, 8, seed=5))
    ]  # fmt: skip
    result = calibrate_from_machine(place.machine, roughly(true, 1), moments)
    ((metres, degrees, square),) = errors(result.cameras, true).values()
    assert metres < 0.005
    assert degrees < 0.1
    assert square < FAR_OUT
    bias, scale = result.depth_errors["north"]
    assert bias + 2.3 * scale == pytest.approx(0.006 + 2.3 * 0.004, abs=0.003)


def test_covariance_covers_what_many_draws_show():
    place = room(people=False)
    true = cameras()[:2]
    moments = poses_of(place, 5, seed=9)
    squares = []
    for seed in range(12):
        result = calibrate_from_machine(
            place.machine, roughly(true, seed, 0.02, 0.5), record(true, moments, seed=seed)
        )
        squares += [square for _, _, square in errors(result.cameras, true).values()]
    inside = np.mean(np.array(squares) < chi2.ppf(0.95, 6))
    assert inside >= 0.83
    assert np.mean(squares) > 1.0


def test_a_lens_that_bends_is_taken_out():
    place = room(people=False)
    straight = cameras()[0]
    bent = replace(
        straight, intrinsics=replace(straight.intrinsics, distortion=(0.08, -0.03, 0.001, -0.001, 0.0))
    )
    result = calibrate_from_machine(
        place.machine, roughly([bent], 1), record([bent], poses_of(place, 8, seed=5))
    )
    ((metres, degrees, square),) = errors(result.cameras, [bent]).values()
    assert metres < 0.005
    assert degrees < 0.15
    assert square < FAR_OUT


def test_a_six_axis_arm_is_a_target_too():
    share = Path(str(importlib.metadata.distribution("example-robot-data").locate_file("cmeel.prefix/share")))
    arm = Machine.from_urdf(share / "example-robot-data/robots/ur_description/urdf/ur5_robot.urdf")
    floor = Solid("floor", join([box((-2, -2, -0.2), (2, 2, -0.02))]), np.eye(4), is_static=True)
    focal = 110.0
    true = DepthCamera(
        "arm",
        160,
        120,
        looking_at((1.3, 0.9, 1.1), (0.0, 0.0, 0.4)),
        Intrinsics(focal, focal, 79.5, 59.5),
        noise=NOISE_PRESETS["tof"],
        max_depth_m=6.0,
    )
    rng = np.random.default_rng(3)
    moments = []
    for number in range(10):
        joints = {name: value / 2 for name, value in random_joints(arm, rng).items()}
        moment = Moment(1.0 + number, (floor, *link_solids(arm, joints)), joints)
        frames = tuple(render([true], moment))
        moments.append(Snapshot(frames, joints, now_ns=moment.stamp_ns))
    result = calibrate_from_machine(arm, roughly([true], 2, 0.06, 3.0), moments)
    ((metres, degrees, square),) = errors(result.cameras, [true]).values()
    assert metres < 0.004
    assert degrees < 0.15
    assert square < FAR_OUT


# what cannot be found is refused, in one line that says what to do


def refused(machine, given, moments, **more):
    with pytest.raises(CalibrationError) as caught:
        calibrate_from_machine(machine, given, moments, **more)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_camera_that_does_not_see_the_machine_is_named():
    place = room(people=False)
    away = camera("away", (0.0, 1.0, 1.5), (0.0, 2.0, 1.2))
    true = [*cameras()[:1], away]
    words = refused(place.machine, true, record(true, poses_of(place, 5)))
    assert "camera away" in words
    assert "move it where this camera sees it" in words


def test_a_rough_pose_that_is_far_off_is_not_made_a_guess(busy):
    machine, true, moments = busy
    words = refused(machine, roughly(true[:1], 3, metres=1.2, degrees=70), moments)
    assert "camera north" in words
    assert "rough pose" in words


def test_too_few_poses(busy):
    machine, true, moments = busy
    assert "at least 4" in refused(machine, true, moments[:3])
    # the same pose again and again is one pose
    assert "1 different poses" in refused(machine, true, [moments[0]] * 6)


def test_joints_that_were_not_recorded(busy):
    machine, true, moments = busy
    words = refused(machine, true, [replace(moment, joints=None) for moment in moments])
    assert "joints.csv" in words


def test_images_of_a_camera_that_was_off(busy):
    machine, true, moments = busy
    silent = [
        replace(moment, frames=tuple(f for f in moment.frames if f.camera != "west")) for moment in moments
    ]
    assert "camera west: images of 0 poses" in refused(machine, true, silent)


def test_base_and_cameras_at_once_need_something_that_fixes_the_world(busy):
    machine, true, moments = busy
    assert "nothing fixes the world" in refused(machine, true, moments, free_base=True)


def test_joints_that_are_not_the_machines_own_are_noticed(busy):
    machine, true, moments = busy
    swapped = [
        replace(moment, joints=other.joints, joints_of=other.joints_of)
        for moment, other in zip(moments, moments[1:] + moments[:1], strict=True)
    ]
    words = refused(machine, true, swapped)
    assert "camera" in words


PLATE_AND_ARM = """<robot name="plate_and_arm">
<link name="base"/>
<link name="plate"><collision><geometry><box size="0.1 6 6"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="0.4 0 0"/><geometry><box size="0.8 0.15 0.1"/></geometry></collision></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="plate"/>
  <axis xyz="1 0 0"/><limit lower="-0.5" upper="0.5" effort="0" velocity="1"/></joint>
<joint name="turn" type="revolute"><parent link="plate"/><child link="arm"/><origin xyz="0.1 0 2.6"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="0" velocity="1"/></joint>
</robot>"""


def test_a_flat_plate_leaves_three_directions_free_and_it_is_said_what_to_move(tmp_path):
    (tmp_path / "plate.urdf").write_text(PLATE_AND_ARM)
    plate = Machine.from_urdf(tmp_path / "plate.urdf")
    true = camera("north", (2.0, 0.1, 0.2), (0.0, 0.0, 0.0))
    joints = [{"slide": -0.5 + 0.2 * number, "turn": 0.0} for number in range(6)]
    moments = [Moment(1.0 + n, link_solids(plate, here), here) for n, here in enumerate(joints)]
    words = refused(plate, roughly([true], 1, 0.02, 1.0), record([true], moments))
    assert "camera north" in words
    assert "do not fix it" in words
    assert "sees only plate: move turn in its view" in words


def shifted(moments, name, by):
    """The images of one camera under the joints of other poses."""
    images = [{frame.camera: frame for frame in moment.frames} for moment in moments]
    given = [
        {**own, name: images[number + by][name]} if 0 <= number + by < len(moments) else
        {key: frame for key, frame in own.items() if key != name}
        for number, own in enumerate(images)
    ]  # fmt: skip
    return [replace(moment, frames=tuple(own.values())) for moment, own in zip(moments, given, strict=True)]


def test_a_camera_that_is_a_pose_late_is_told(busy):
    machine, true, moments = busy
    name = true[1].name
    with pytest.raises(
        CalibrationError, match=f"camera {name}: its images fit the joints of one pose before"
    ):
        calibrate_from_machine(machine, roughly(true, 1), shifted(moments, name, -1))


def test_two_folders_that_were_exchanged_are_told(busy):
    machine, true, moments = busy
    one, other = true[0].name, true[1].name
    names = {one: other, other: one}
    swapped = [
        replace(m, frames=tuple(replace(f, camera=names.get(f.camera, f.camera)) for f in m.frames))
        for m in moments
    ]
    with pytest.raises(CalibrationError, match=r"fit at the place of camera .* exchange the two folders"):
        calibrate_from_machine(machine, roughly(true, 1), swapped)
