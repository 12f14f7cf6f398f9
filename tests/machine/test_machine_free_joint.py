"""Bases that move: planar and floating joints, and a machine at another place."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.errors import MachineError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.machine import Link, Machine, body_samples, body_words, explain_frames
from elbowroom.machine.rasterise import rasterise
from elbowroom.motion import Motion, check_motion, joint_motions
from elbowroom.motion.skin import skin_of
from elbowroom.reconstruct import FreeSpace
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot
from reference import machine_twins as naive

seeds = st.integers(0, 2**32 - 1)
ARM_AT = {"slide": 0.1, "elbow": 0.4, "grip": 0.02}
GRID = VoxelGrid(origin_m=(-1, -1, -1), shape=(50, 50, 50), voxel_size_m=0.04)
PLATFORM = """<robot name="platform"><link name="world"/>
<link name="base"><collision><origin xyz="0 0 .1"/><geometry><box size=".4 .3 .2"/></geometry></collision></link>
<link name="arm"><collision><origin xyz=".1 0 .25"/><geometry><box size=".3 .05 .05"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="drive" type="KIND"><parent link="world"/><child link="base"/><origin xyz="0.1 0 0" rpy="0 0 0.5"/>
<axis xyz="AXIS"/></joint></robot>"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


def platform(folder, kind, axis="0 0 1"):
    path = folder / "platform.urdf"
    path.write_text(PLATFORM.replace("KIND", kind).replace("AXIS", axis))
    return Machine.from_urdf(path)


def pose_of(seed):
    rng = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(rng=rng).as_matrix()
    pose[:3, 3] = rng.uniform(-0.3, 0.3, 3)
    return pose


@settings(max_examples=20)
@given(seed=seeds)
def test_a_base_that_moves_moves_all(arm, seed):
    pose, home = pose_of(seed), pose_of(seed + 1)
    moved = arm.at(home).with_free_base("floating")
    joints = ARM_AT | moved.free_positions("base", pose)
    assert all(isinstance(value, float) for value in joints.values())
    placed, there = moved.world_from_links(joints), arm.at(home @ pose).world_from_links(ARM_AT)
    for link in arm.link_names:
        np.testing.assert_allclose(placed[link], there[link], atol=1e-9)
        np.testing.assert_allclose(there[link], home @ pose @ arm.world_from_links(ARM_AT)[link], atol=1e-9)


@settings(max_examples=10)
@given(seed=seeds)
def test_the_machine_at_a_place_is_the_one_that_was_read_there(arm, seed, tmp_path_factory):
    path = tmp_path_factory.mktemp("there") / "arm.urdf"
    path.write_text(naive.ARM)
    pose = pose_of(seed)
    read = Machine.from_urdf(path, world_from_base=pose, unchecked_links=("foot",))
    assert (body_words(read, ARM_AT, GRID) == body_words(arm.at(pose), ARM_AT, GRID)).all()


def test_another_place_samples_nothing_anew(arm):
    samples, skin = body_samples(arm, 0.05), skin_of(arm, 0.05)
    for seed in range(3):
        there = arm.at(pose_of(seed))
        assert body_samples(there, 0.05) is samples
        assert skin_of(there, 0.05) is skin
    with pytest.raises(MachineError, match="world_from_base"):
        arm.at(np.diag([1, 1, 2, 1]))


@pytest.mark.parametrize("axis", ["0 0 1", "0 0 2", "1 0 0", "0 0 -1", "0.3 -0.5 0.6"])
def test_a_planar_joint_slides_in_its_plane_and_turns_about_its_normal(tmp_path, axis):
    machine = platform(tmp_path, "planar", axis)
    assert machine.joint_names == ("drive/x", "drive/y", "drive/yaw", "j")
    normal = np.array(axis.split(), dtype=float)
    normal /= np.linalg.norm(normal)
    home = machine.joints[0].parent_from_joint
    where = {"drive/x": 0.3, "drive/y": -0.2, "drive/yaw": 2.0, "j": 0.1}
    found = np.linalg.inv(home) @ machine.world_from_links(where)["base"]
    assert found[:3, 3] @ normal == pytest.approx(0, abs=1e-12)
    assert np.linalg.norm(found[:3, 3]) == pytest.approx(np.hypot(0.3, 0.2))
    np.testing.assert_allclose(found[:3, :3], Rotation.from_rotvec(2.0 * normal).as_matrix(), atol=1e-12)
    back = machine.free_positions("drive", machine.world_from_links(where)["base"])
    assert back == pytest.approx({name: where[name] for name in back})
    assert set(machine.moved_links("drive/x")) >= {"base", "arm"}
    assert machine.joint("drive/x").unit == "m" and machine.joint("drive/yaw").unit == "rad"


def test_a_platform_can_be_asked_to_drive(tmp_path):
    machine = platform(tmp_path, "planar")
    here = {"drive/x": 0.0, "drive/y": 0.0, "drive/yaw": -0.5, "j": 0.0}
    wall = np.zeros(GRID.shape, dtype=bool)
    wall[45:] = True
    space = FreeSpace.from_occupied(GRID, wall).without(machine, here)
    found = check_motion(space, machine, here, Motion("drive/x", 1, 0.5))
    # the joint's x lies 0.5 rad off the world's
    assert 0.3 < found.free_travel < 0.66
    assert len(joint_motions(machine, dict.fromkeys(machine.joint_names, 0.1), 0.5)) == 8


def test_nobody_asks_motions_of_a_floating_joint_but_who_gives_it_speeds(tmp_path):
    machine = platform(tmp_path, "floating")
    parts = ("drive/x", "drive/y", "drive/z", "drive/yaw", "drive/pitch", "drive/roll")
    assert machine.joint_names == (*parts, "j")
    assert {motion.joint for motion in joint_motions(machine, {"j": 0.1}, 0.5)} == {"j"}
    assert {motion.joint for motion in joint_motions(machine, {"j": 0.1, "drive/x": 1.0}, 0.5)} == {
        "j",
        "drive/x",
    }
    with pytest.raises(MachineError, match="'j' has no speed"):
        joint_motions(machine, {"drive/x": 0.1}, 0.5)


def test_followers_and_joints_beside_a_free_one_keep_their_leaders(arm):
    for kind in ("planar", "floating"):
        moved = arm.with_free_base(kind)
        assert moved.joint_names[-3:] == arm.joint_names
        joints = ARM_AT | dict.fromkeys(moved.joint_names[:-3], 0.0)
        for link, placed in arm.world_from_links(ARM_AT).items():
            np.testing.assert_array_equal(moved.world_from_links(joints)[link], placed)


def test_what_a_free_joint_may_not_be(arm, tmp_path):
    with pytest.raises(MachineError, match="is there already"):
        arm.with_free_base("planar").with_free_base("planar")
    assert len(arm.with_free_base("planar", "cart").with_free_base("planar").joint_names) == 9
    with pytest.raises(MachineError, match="no planar or floating joint"):
        arm.free_positions("base", np.eye(4))
    tilted = np.eye(4)
    tilted[:3, :3] = Rotation.from_euler("x", 0.1).as_matrix()
    with pytest.raises(MachineError, match=r"tilted by 0.1 rad"):
        arm.with_free_base("planar").free_positions("base", tilted)
    for nose in (np.pi / 2, -np.pi / 2):
        up = np.eye(4)
        up[:3, :3] = Rotation.from_euler("ZYX", [0.7, nose, 0.3]).as_matrix()
        machine = arm.with_free_base("floating")
        placed = machine.world_from_links(ARM_AT | machine.free_positions("base", up))
        np.testing.assert_allclose(placed["foot"], up, atol=1e-6)


def test_each_camera_explains_the_base_where_it_was_at_its_frame(arm):
    machine = arm.with_free_base("planar")
    eye = np.array([[1.0, 0, 0, 0], [0, 0, 1, -2.5], [0, -1, 0, 0.3], [0, 0, 0, 1]])
    cameras = [DepthCamera(name, 80, 60, eye, Intrinsics(60, 60, 39.5, 29.5)) for name in ("early", "late")]
    stamps = np.array([0, 100_000_000])
    rows = {name: np.full(2, value) for name, value in ARM_AT.items()}
    rows |= {"base/x": np.array([0.0, 0.5]), "base/y": np.zeros(2), "base/yaw": np.array([3.1, -3.1])}
    record = JointRecord(stamps, rows)
    images = [
        rasterise(machine, camera, record.at(int(t))) for camera, t in zip(cameras, stamps, strict=True)
    ]
    images = [np.where(np.isfinite(image), image, 4.0).astype(np.float32) for image in images]
    frames = [DepthFrame(c.name, int(t), image) for c, t, image in zip(cameras, stamps, images, strict=True)]
    moment = Snapshot.taken(frames, record)
    then = [moment.joints_at(camera.name) for camera in cameras]
    right = explain_frames(machine, cameras, images, then).model_depth
    one_place = explain_frames(machine, cameras, images, [record.at(0)] * 2).model_depth
    for image, name in zip(images, ("early", "late"), strict=True):
        assert (right[name] > 0)[image < 4].all()
    assert not (one_place["late"] > 0)[images[1] < 4].all()


def test_a_record_turns_a_base_the_shortest_way():
    stamps = np.array([0, 1000])
    yaw = JointRecord(stamps, {"base/yaw": np.array([3.1, -3.1]), "elbow": np.array([3.1, -3.1])}).at(500)
    assert abs(yaw["base/yaw"]) == pytest.approx(np.pi) and yaw["elbow"] == pytest.approx(0)
    first, last = Rotation.from_euler("ZYX", [0.2, 1.5, 0.4]), Rotation.from_euler("ZYX", [3.0, 1.55, -3.0])
    rows = np.stack([first.as_euler("ZYX"), last.as_euler("ZYX")])
    names = ("drive/yaw", "drive/pitch", "drive/roll")
    found = JointRecord(stamps, dict(zip(names, rows.T, strict=True)) | {"drive/x": np.array([0.0, 1.0])}).at(
        250
    )
    turned = Rotation.from_euler("ZYX", [found[name] for name in names])
    whole = (first.inv() * last).magnitude()
    assert (first.inv() * turned).magnitude() == pytest.approx(whole / 4)
    assert (turned.inv() * last).magnitude() == pytest.approx(3 * whole / 4)
    assert found["drive/x"] == pytest.approx(0.25)


def test_machines_that_differ_by_their_place_alone_share_what_is_kept(arm):
    seen = tuple(replace(link, seen=Link(link.name, link.vertices, link.faces)) for link in arm.links)
    machine = replace(arm, links=seen)
    for seed in range(2):
        there = machine.at(pose_of(seed))
        assert there.anywhere is machine and machine.anywhere is machine
        assert there.as_seen.shape is machine.as_seen.shape
        np.testing.assert_allclose(there.as_seen.world_from_base, there.world_from_base, atol=1e-12)
    assert replace(machine, unchecked_links=()).anywhere is not machine
    assert machine.allowing(("foot", "fore")).anywhere is not machine
