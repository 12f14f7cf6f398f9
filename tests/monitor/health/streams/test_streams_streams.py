"""What is found of cameras and joints that come moment by moment: named, left out, and over by its own evidence."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.finding import Finding
from elbowroom.machine.probe import probe
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.health import CameraHealth, Condition, Health
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.monitor.health.streams.streams import Streams, Ways, without_sick
from elbowroom.monitor.health.streams.told import SickRows, sick_lines
from elbowroom.sensing import DepthFrame, Snapshot
from reference.small_streams import STEP_NS, T0_NS, Sensor, a_camera, moment, walls

CAMERAS = [a_camera("c0"), a_camera("c1"), a_camera("c2")]
MACHINE = probe()


class Room:
    """Three sensors, a machine that slides to and fro, and all that is heard of them."""

    def __init__(self, repeating=(), **ways):
        self.sensors = {
            "c0": Sensor(CAMERAS[0], 1.5, 1),
            "c1": Sensor(CAMERAS[1], 1.0, 2),
            "c2": Sensor(CAMERAS[2], 2.2, 3),
        }
        self.sensors["c1"].room_m = walls(CAMERAS[1]).T.copy().repeat(2, axis=1)[:48, :64] * 0.7
        told = Ways(repeating=frozenset(repeating), greatest={"slide": 0.5}, **ways)
        self.streams = Streams(CAMERAS, MACHINE, told, clock_ns=lambda: self.number * STEP_NS)
        self.number = 0

    def images(self):
        return {name: sensor.image() for name, sensor in self.sensors.items()}

    def joints(self):
        return {"slide": 0.01 * np.sin(self.number / 10)}

    def hear(self, images=None, found=(), **more):
        self.number += 1
        told = {"joints": self.joints(), "joints_ns": T0_NS + self.number * STEP_NS, **more}
        snapshot = moment(self.images() if images is None else images, self.number, **told)
        return self.hear_snapshot(snapshot, found)

    def hear_snapshot(self, snapshot, found=()):
        return self.streams.hear(snapshot, found)

    def well(self, many=12):
        for _ in range(many):
            sick = self.hear()
        assert not sick, sick


def words(sick):
    return {(each.source, each.cause.word) for each in sick}


def test_cameras_and_joints_that_come_are_well_from_the_first_moment_on():
    room = Room()
    for _ in range(60):
        assert not room.hear()


def test_before_anything_came_each_camera_is_awaited_by_name_and_later_disconnected():
    room = Room()
    sick = room.hear({}, joints=None, joints_ns=None)
    assert words(sick) == {("c0", "starting"), ("c1", "starting"), ("c2", "starting"), ("joints", "starting")}
    assert not any(each.latches for each in sick) and "awaited" in sick[0].text
    for _ in range(90):
        sick = room.hear({}, joints=None, joints_ns=None)
    assert ("c0", "disconnected") in words(sick) and ("joints", "missing") in words(sick)
    assert {each.source for each in sick if each.latches} == {"c0", "c1", "c2", "joints"}
    for _ in range(4):
        sick = room.hear()
    assert not sick


def fault_of_image(name):
    """By its word, what makes of a room's images those with a fault of camera c0."""
    last = {}

    def frozen(images):
        last.setdefault("image", images["c0"])
        return {**images, "c0": last["image"].copy()}

    def frozen_in_part(images):
        last.setdefault("image", images["c0"])
        image = images["c0"].copy()
        image[:24] = last["image"][:24]
        return {**images, "c0": image}

    def part(images):
        image = images["c0"].copy()
        image[20:] = 0
        return {**images, "c0": image}

    return {
        "gaps": lambda images: {**images, "c0": None},
        "frozen": frozen,
        "frozen in part": frozen_in_part,
        "covered": lambda images: {**images, "c0": np.zeros_like(images["c0"])},
        "partly_covered": part,
        "wrong_size": lambda images: {**images, "c0": images["c0"][::2, ::2].copy()},
        "wrong_scale": lambda images: {**images, "c0": images["c0"] * np.float32(4)},
        "wrong_encoding": lambda images: {**images, "c0": np.float32(0.1) / images["c0"]},
        "swapped": lambda images: {**images, "c0": images["c1"], "c1": images["c0"]},
    }[name]


FAULTS = (
    "gaps", "frozen", "frozen in part", "covered", "partly_covered", "wrong_size", "wrong_scale", "wrong_encoding",
    "swapped",
)  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named_and_left_out_in_time_and_over_by_its_own_evidence(name):
    room, fault = Room(), fault_of_image(name)
    room.well()
    about = {"c0", "c1"} if name == "swapped" else {"c0"}
    late = 0
    while not (sick := room.hear(fault(room.images()))):
        late += 1
    # the first wrong image of those that one image shows; the second or third of the others
    assert late <= {"covered": 1, "partly_covered": 1, "frozen": 1, "frozen in part": 1, "gaps": 2}.get(
        name, 0
    )
    assert words(sick) == {(camera, name.split()[0]) for camera in about}
    assert all(each.latches and each.leaves_out and each.lasts_s == 0 for each in sick)
    for _ in range(8):
        assert words(room.hear(fault(room.images()))) == words(sick)
    over = 0
    while sick := room.hear():
        over += 1
        assert words(sick) == {(camera, name.split()[0]) for camera in about}
    assert 2 <= over <= 6
    room.well(30)


def test_a_camera_that_stays_away_is_disconnected_and_not_named_twice():
    room = Room()
    room.well()
    for _ in range(40):
        sick = room.hear({**room.images(), "c1": None})
    assert words(sick) == {("c1", "disconnected")}


def test_one_lost_image_is_nothing():
    room = Room()
    room.well()
    for _ in range(20):
        assert not room.hear({**room.images(), "c1": None})
        assert not room.hear()


def test_stamps_that_stand_still_under_images_that_are_given_anew_are_frozen():
    room = Room()
    room.well()
    for _ in range(4):
        room.number += 1
        images = room.images()
        now_ns = T0_NS + room.number * STEP_NS
        frames = [DepthFrame(n, now_ns if n != "c0" else T0_NS, image) for n, image in images.items()]
        frames[0] = DepthFrame("c0", T0_NS + 12 * STEP_NS, images["c0"])
        sick = room.hear_snapshot(Snapshot(tuple(frames), room.joints(), now_ns=now_ns))
    assert ("c0", "frozen") in words(sick)


@pytest.mark.parametrize("repeats", [False, True])
def test_an_exact_source_may_repeat_itself_if_the_site_says_so(repeats):
    room = Room(repeating=("c0",) if repeats else ())
    image = room.sensors["c0"].image()
    for _ in range(20):
        sick = room.hear({**room.images(), "c0": image.copy()})
    assert words(sick) == (set() if repeats else {("c0", "frozen")})


def test_images_that_come_later_than_usual_are_too_old():
    for limit_ns in (None, 100_000_000):
        room = Room(max_age_ns=limit_ns)
        room.well(15)
        for _ in range(3):
            room.number += 1
            now_ns = T0_NS + room.number * STEP_NS
            images = room.images()
            frames = [DepthFrame(n, now_ns - (300_000_000 if n == "c2" else 0), i) for n, i in images.items()]
            sick = room.hear_snapshot(Snapshot(tuple(frames), room.joints(), now_ns=now_ns))
        assert words(sick) == {("c2", "too_old")}


def test_what_looks_at_times_and_the_source_found_is_a_cause_by_name():
    room = Room()
    room.well()
    order = Finding("order", ("c0",), "camera c0 went back in time by 2 s", True)
    damaged = Finding("damaged", ("c1",), "camera c1 is left out: truncated", False)
    other = Finding("clock", ("c2",), "camera c2: its clock is ahead; taken back by that", False)
    sick = room.hear(found=(order, damaged, other))
    assert words(sick) == {("c0", "clock"), ("c1", "damaged")}


def test_a_camera_that_was_moved_is_named_as_the_watch_says_it():
    room = Room()
    health = Health(
        (
            CameraHealth("c0", Condition.MOVED, None, 0.5, 0.0),
            CameraHealth("c1", Condition.SILENT, None, 0, 1),
        ),
        (),
        {"c0": "camera c0 has turned by 2 degrees", "c1": "camera c1 gives no new image"},
    )
    assert words(room.streams.knowing((), health)) == {("c0", "moved")}


def test_a_camera_that_may_be_elsewhere_is_left_out_until_the_watch_has_decided():
    room, still = Room(), Condition.STILL
    cameras = (
        CameraHealth("c0", still, None, 0.5, 0.0, "may be elsewhere"),
        CameraHealth("c1", still, None, 1, 0),
    )
    (sick,) = room.streams.knowing((), Health(cameras))
    assert (sick.source, sick.cause.word, sick.leaves_out, sick.latches) == ("c0", "doubted", True, False)
    decided = Health(cameras, (), {"c0": "camera c0 has turned"})
    assert (
        words(room.streams.knowing((), decided)) == set()
    )  # it stops as the watch says it, and is said once


JOINT_FAULTS = {
    "missing": lambda n: {"joints": None, "joints_ns": None},
    "beyond": lambda n: {"joints": {"slide": 99.0}},
    "implausible": lambda n: {"joints": {"slide": 0.09 if n % 2 else -0.09}},
    "implausible: no number": lambda n: {"joints": {"slide": float("nan")}},
    "frozen: stamp": lambda n: {"joints_ns": T0_NS + 12 * STEP_NS},
    "frozen: commanded": lambda n: {"joints": {"slide": 0.0}, "commanded": {"slide": 0.1}},
}


@pytest.mark.parametrize("name", JOINT_FAULTS)
def test_a_fault_of_joints_stops_and_is_over_by_its_own_evidence(name):
    room, word = Room(), name.split(":")[0]
    room.well()
    late = 0
    while not (sick := room.hear(**JOINT_FAULTS[name](room.number + 1))):
        late += 1
    assert late <= (0 if word in ("missing", "beyond", "implausible") else 3)
    assert words(sick) == {("joints", word)} and sick[0].stops and sick[0].latches
    over = 0
    while sick := room.hear():
        over += 1
        assert ("joints", word) in words(sick)
    assert 2 <= over <= 6
    room.well(30)


def test_a_machine_that_stands_still_and_is_not_commanded_is_well():
    room = Room()
    for n in range(40):
        assert not room.hear(joints={"slide": 0.0}, commanded={"slide": 0.0} if n > 20 else None)


@settings(max_examples=30)
@given(st.lists(st.sampled_from([None, *FAULTS[:8]]), min_size=1, max_size=25), st.integers(0, 2**16))
def test_what_is_left_out_is_what_is_sick_and_nothing_else_whatever_comes(faults, seed):
    """Less evidence alone: what remains of a moment are frames of it, as they came, of cameras that are well."""
    room = Room()
    room.sensors["c0"].random = np.random.default_rng(seed)
    for fault in faults:
        images = room.images() if fault is None else fault_of_image(fault)(room.images())
        room.number += 1
        snapshot = moment(images, room.number, room.joints(), joints_ns=T0_NS + room.number * STEP_NS)
        sick = room.hear_snapshot(snapshot)
        left = without_sick(snapshot, sick).frames
        out = {each.source for each in sick}
        assert left == tuple(frame for frame in snapshot.frames if frame.camera not in out)
        assert not out & {"c1", "c2", "joints"}
        assert all(frame.depth_m.shape == (48, 64) for frame in left)


def test_a_source_without_times_is_looked_at_all_the_same():
    room = Room()
    for _ in range(5):
        images = room.images()
        frames = tuple(DepthFrame(n, None, i) for n, i in images.items())
        assert not room.hear_snapshot(Snapshot(frames, {"slide": 0.0}))
    again = tuple(DepthFrame(f.camera, None, f.depth_m.copy()) for f in frames)
    assert {each.cause for each in room.hear_snapshot(Snapshot(again, {"slide": 0.0}))} == {
        HealthCause.CAMERA_FROZEN
    }


def test_it_is_said_when_it_comes_each_second_and_when_it_is_over():
    time_s = [0.0]
    rows = SickRows(lambda: time_s[0])
    sick = Sick(HealthCause.CAMERA_FROZEN, "c0", "camera c0 gives the image before again", "3 new images")
    told = []
    for number in range(26):
        time_s[0] = number / 10
        told += [(number, row["is_there"], row["cause"], row["source"]) for row in rows.rows((sick,))]
    assert told == [(n, True, "frozen", "c0") for n in (0, 10, 20)]
    assert [(row["is_there"], row["cause"]) for row in rows.rows(())] == [(False, "frozen")]
    assert rows.rows(()) == []
    assert sick_lines((sick,)) == [
        "Left out: camera c0 gives the image before again (until 3 new images; 0.0 s)"
    ]


def test_a_cause_that_the_site_tolerates_latches_nothing():
    room = Room(tolerated=frozenset({"gaps"}))
    room.well()
    for _ in range(4):
        sick = room.hear({**room.images(), "c1": None})
    assert words(sick) == {("c1", "gaps")} and sick[0].leaves_out and not sick[0].latches
    assert not replace(sick[0], cause=HealthCause.CAMERA_STARTING, tolerated=False).latches


def commissioned():
    """A room whose cameras were commissioned on what their sensors show, and nothing has come yet."""
    room, commissioning = Room(), Commissioning(CAMERAS, None, 6)
    for number in range(6):
        commissioning.add(moment(room.images(), number))
    told = Ways(greatest={"slide": 0.5})
    room.streams = Streams(CAMERAS, MACHINE, told, commissioning.references(), lambda: 0)
    return room


@pytest.mark.parametrize("name", ["swapped", "wrong_scale", "wrong_encoding", "partly_covered", "covered"])
def test_beside_what_was_commissioned_a_fault_is_there_from_the_first_image_on(name):
    room, fault = commissioned(), fault_of_image(name)
    about = {"c0", "c1"} if name == "swapped" else {"c0"}
    for _ in range(3):
        sick = room.hear(fault(room.images()))
    assert {(camera, name) for camera in about} <= words(sick)
    assert {source for source, _ in words(sick)} == about


def test_commissioned_cameras_that_show_what_they_did_are_well():
    commissioned().well(40)
