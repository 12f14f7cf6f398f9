"""Messages beside other readers and writers: rosbags, mcap-ros2-support, OpenCV's shapes of RVL from its paper."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap_ros2.writer import Writer as Ros2Writer

from elbowroom.errors import BagError, FrameError
from elbowroom.sources.bags import messages, trajectories
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.cdr import Cdr
from elbowroom.sources.bags.depth import depth_of
from elbowroom.sources.bags.rvl import rvl_pixels
from reference import bag_files as bags

names = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=9)
reals = st.floats(allow_nan=False)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(names, reals), max_size=6), st.integers(0, 2**31 - 1), st.integers(0, 10**9 - 1), names
)
def test_joint_states_of_every_alignment(rows, seconds, rest, frame):
    joints, positions = [name for name, _ in rows], [value for _, value in rows]
    sent = bags.joint_state(positions, seconds * 10**9 + rest, names=joints)
    sent.header.frame_id = frame
    for order in (True, False):
        data = bytes(bags.STORE.serialize_cdr(sent, bags.JOINTS, little_endian=order))
        found = messages.joint_state_of(data, "m")
        assert found.header == (seconds * 10**9 + rest, frame)
        assert list(found.names) == joints and found.positions.tolist() == positions


@settings(max_examples=40)
@given(names, names, st.lists(reals, min_size=7, max_size=7))
def test_transforms_and_camera_infos_of_every_alignment(parent, child, numbers):
    sent = bags.transform(parent, child, np.eye(4), 5)
    place, turn = sent.transform.translation, sent.transform.rotation
    place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = numbers
    data = bytes(bags.STORE.serialize_cdr(bags.transforms(sent, sent), bags.TF))
    found = messages.transforms_of(data, "m")
    assert len(found) == 2 and found[1].child == child and found[1].header == (5, parent)
    assert [*found[1].translation, *found[1].rotation] == numbers


def test_a_file_of_other_peoples_serialiser(tmp_path):
    """mcap-ros2-support writes by the definition that it is given, with code of its own."""
    definition = (
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
        "uint8[] data\n"
        + "=" * 80 + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
        + "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    )  # fmt: skip
    pixels = np.arange(12, dtype=np.uint16).reshape(3, 4)
    sent = {
        "header": {"stamp": {"sec": 7, "nanosec": 5}, "frame_id": "east"},
        "height": 3, "width": 4, "encoding": "16UC1", "is_bigendian": 0, "step": 8, "data": pixels.tobytes(),
    }  # fmt: skip
    with (tmp_path / "own.mcap").open("wb") as file, Ros2Writer(file) as writer:
        schema = writer.register_msgdef("sensor_msgs/msg/Image", definition)
        writer.write_message("/east/image", schema, sent, log_time=10**10, publish_time=1, sequence=1)
    with Bag(tmp_path / "own.mcap") as bag:
        (stored,) = bag.messages("/east/image")
        assert (stored.received_ns, bag.stamp_ns(stored)) == (10**10, 7 * 10**9 + 5)
        assert np.array_equal(depth_of(messages.IMAGE, bag.read(stored), "m", (4, 3)), pixels)


def rvl(pixels):
    """Wilson's encoder, pixel by pixel."""
    nibbles, flat = [], pixels.ravel().astype(int).tolist()

    def number(value):
        while True:
            nibble, value = value & 7, value >> 3
            nibbles.append(nibble | (8 if value else 0))
            if not value:
                return

    at, before = 0, 0
    while at < len(flat):
        empty = at
        while empty < len(flat) and not flat[empty]:
            empty += 1
        full = empty
        while full < len(flat) and flat[full]:
            full += 1
        number(empty - at)
        number(full - empty)
        for depth in flat[empty:full]:
            delta = depth - before
            number((delta << 1) ^ (delta >> 31))
            before = depth
        at = full
    nibbles += [0] * (-len(nibbles) % 8)
    words = [int("".join(f"{n:x}" for n in nibbles[i : i + 8]), 16) for i in range(0, len(nibbles), 8)]
    return struct.pack(f"<{len(words)}I", *words)


@settings(max_examples=60)
@given(
    st.integers(1, 9), st.integers(1, 9), st.randoms(use_true_random=False), st.sampled_from((2, 900, 65535))
)
def test_runs_and_differences_come_back(width, height, chance, most):
    pixels = np.array(
        [chance.choice((0, 0, chance.randint(0, most))) for _ in range(width * height)], dtype=np.uint16
    ).reshape(height, width)
    assert np.array_equal(rvl_pixels(rvl(pixels), "m", width, height), pixels)
    sent = bags.compressed(
        struct.pack("<II", width, height) + rvl(pixels) + bytes(26), 0, "", "16UC1; compressedDepth rvl"
    )
    data = bytes(bags.STORE.serialize_cdr(sent, bags.COMPRESSED))
    assert np.array_equal(depth_of(bags.COMPRESSED, data, "m", (width, height)), pixels)


@given(st.binary(max_size=200))
def test_runs_that_are_none_are_refused(data):
    try:
        assert rvl_pixels(data, "m", 5, 4).shape == (4, 5)
    except FrameError as error:
        assert str(error).startswith("m: ")


def test_lengths_are_checked_before_anything_is_made_of_them():
    huge = struct.pack("<4sI", b"\x00\x01\x00\x00", 2**32 - 1) + bytes(20)
    for read in (Cdr.reals, Cdr.texts, Cdr.octets, Cdr.text):
        with pytest.raises(messages.BagError, match=r"4,294,967,295 values follow"):
            read(Cdr(huge, "m"))


@settings(max_examples=40)
@given(st.data(), st.lists(names, min_size=1, max_size=4), st.booleans(), st.booleans())
def test_trajectories_of_every_alignment_beside_rosbags(data, joints, with_velocities, shown):
    row = st.lists(reals, min_size=len(joints), max_size=len(joints)).map(np.array)
    points = [
        bags.made(
            "trajectory_msgs/msg/JointTrajectoryPoint",
            positions=data.draw(row),
            velocities=data.draw(row) if with_velocities else np.zeros(0),
            accelerations=data.draw(row),
            effort=np.zeros(0),
            time_from_start=bags.made("builtin_interfaces/msg/Duration", sec=n, nanosec=n * 7),
        )
        for n in range(data.draw(st.integers(1, 4)))
    ]
    sent = bags.made(
        trajectories.JOINT_TRAJECTORY, header=bags.header(5, "base"), joint_names=joints, points=points
    )
    raw, type_ = (
        bytes(bags.STORE.serialize_cdr(sent, trajectories.JOINT_TRAJECTORY)),
        trajectories.JOINT_TRAJECTORY,
    )
    if (
        shown
    ):  # MoveIt's message begins with a model's name and how many paths there are; here both fill eight bytes
        raw, type_ = (
            raw[:4] + struct.pack("<I4sII", 4, b"arm\0", 1, 0)[:12] + raw[4:],
            trajectories.DISPLAY_TRAJECTORY,
        )
    if shown and len(raw[4:16]) % 8:
        return
    found = trajectories.planned_of(type_, raw, "m")
    assert found.stamp_ns == 5 and list(found.names) == joints
    assert found.since_ns == [n * 1_000_000_007 for n in range(len(points))]
    assert found.positions.tolist() == [point.positions.tolist() for point in points]
    assert (found.velocities is None) is not with_velocities
    with pytest.raises(BagError):
        trajectories.planned_of(type_, raw[:-5], "m")
