"""A bag that is played: the newest frame of each camera, on one clock, with what its age may be off."""

import math

import numpy as np
import pytest

from elbowroom.errors import JointsError, SiteError
from elbowroom.site import Site
from elbowroom.sources import Played, live, moments, open_room, time_findings
from reference import bag_files as bags
from reference.bag_room import LATE_NS, STEP_NS, bag_room

T0, MS, S = bags.T0, bags.MS, 1_000_000_000


class Time:
    """A clock that stands still unless somebody sleeps, or judges for so long."""

    def __init__(self):
        self.now_ns, self.slept = 0, []

    def __call__(self):
        return self.now_ns

    def sleep(self, seconds):
        self.slept.append(seconds)
        self.now_ns += max(round(seconds * 1e9), 1)


def site_of(tmp_path, messages, **more):
    room = bag_room()
    bag = bags.written(tmp_path / "bag", sorted(messages, key=lambda m: m[1]))
    return Site.load(room.site(tmp_path / "site.yaml", room.recording(bag) | more))


def played(site, judge_ns=0, **more):
    """All snapshots, with what was found at each, for someone who takes so long to judge one."""
    time = Time()
    source = Played(site, clock_ns=time, sleep=time.sleep, **more)
    found = []
    for snapshot in source:
        found.append((snapshot, source.findings, dict(source.clocks)))
        time.now_ns += judge_ns
    return found, time


def later(messages, change):
    """The same messages, each with other times: change(topic, received, stamp) gives received and stamp."""
    found = []
    for topic, at, message in messages:
        stamp = at - LATE_NS
        if "image_raw" in topic:
            at, stamp = change(topic.split("/")[1], at, stamp)
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, S)
        found.append((topic, at, message))
    return found


def test_who_is_quick_gets_every_moment(tmp_path):
    site = site_of(tmp_path, bag_room().messages())
    found, time = played(site)
    by_folder = list(moments(site))
    assert len(found) == len(by_folder) == 4
    for (snapshot, findings, clocks), moment in zip(found, by_folder, strict=True):
        assert findings == ()
        assert snapshot.now_ns == moment.now_ns + LATE_NS
        assert [f.stamp_ns for f in snapshot.frames] == [f.stamp_ns for f in moment.frames]
        for mine, theirs in zip(snapshot.frames, moment.frames, strict=True):
            assert np.array_equal(mine.depth_m, theirs.depth_m)
        assert snapshot.joints_of == moment.joints_of
        # by the last that was said before now, and none from later
        assert snapshot.joints == bag_room().joints[moment.now_ns]
        assert {name: c.offset_ns for name, c in clocks.items()} == dict.fromkeys(clocks, LATE_NS)
        assert snapshot.skew_ms == 0
        bound = snapshot.clock_bounds_ns["cam00"] / 1e6
        assert 4 < bound < 5 and snapshot.oldest_age_ms == pytest.approx(12 + bound)
    assert sum(time.slept) == pytest.approx(0.3)


def test_who_is_slow_gets_the_newest_and_never_what_has_not_come(tmp_path):
    found, _ = played(site_of(tmp_path, bag_room().messages()), judge_ns=150 * MS)
    stamps = [snapshot.frames[0].stamp_ns for snapshot, *_ in found]
    assert stamps == [T0, T0 + STEP_NS, T0 + 3 * STEP_NS]
    assert all(snapshot.frames[0].stamp_ns + LATE_NS <= snapshot.now_ns for snapshot, *_ in found)


def test_a_camera_that_falls_silent_grows_old_and_is_left_out_of_the_moment(tmp_path):
    messages = [m for m in bag_room().messages() if "cam01/depth/image" not in m[0] or m[1] == T0 + LATE_NS]
    found, _ = played(site_of(tmp_path, messages, max_skew_ms=150))
    names = [[frame.camera for frame in snapshot.frames] for snapshot, *_ in found]
    assert "cam01" in names[0] and "cam01" in names[1] and "cam01" not in [*names[2], *names[3]]
    assert [snapshot.skew_ms for snapshot, *_ in found] == [0, 100, 0, 0]
    (said,) = found[2][1]
    assert said.about == ("cam01",) and not said.stops and "0.2 s older than the newest of all" in said.text


def test_where_nothing_comes_the_same_comes_again_older(tmp_path):
    messages = [m for m in bag_room().messages() if m[1] < T0 + 50 * MS or m[1] > T0 + 250 * MS]
    messages = [(t, at + S * (at > T0 + 250 * MS), m) for t, at, m in messages]
    found, _ = played(site_of(tmp_path, later(messages, lambda c, at, stamp: (at, at - LATE_NS))))
    ages = [snapshot.oldest_age_ms for snapshot, *_ in found]
    assert len(found) >= 6 and ages[5] > ages[4] > ages[3] > 500 and ages[-1] < 20
    assert all(snapshot.fresh(200 * MS).frames == () for snapshot, *_ in found[2:-1])
    # and a machine of which nothing was heard for so long is nowhere
    said = [finding for _, findings, _ in found for finding in findings]
    assert any(f.kind == "joints" and f.stops and "nothing was said for" in f.text for f in said)


def test_gaps_are_skipped(tmp_path):
    messages = [(t, at + 3600 * S * (at > T0 + 250 * MS), m) for t, at, m in bag_room().messages()]
    messages = later(messages, lambda c, at, stamp: (at, at - LATE_NS))
    found, time = played(site_of(tmp_path, messages))
    assert sum(time.slept) < 1 and found[-1][0].now_ns == T0 + 3600 * S + 300 * MS + LATE_NS


def test_a_damaged_image_is_no_frame_and_said(tmp_path):
    messages = bag_room().messages()
    at = next(i for i, m in enumerate(messages) if m[0] == "/cam02/depth/image_raw" and m[1] > T0 + 150 * MS)
    messages[at][2].data = messages[at][2].data[:99]
    found, _ = played(site_of(tmp_path, messages))
    assert [len(snapshot.frames) for snapshot, *_ in found] == [4, 4, 3, 4]
    (said,) = found[2][1]
    assert said.about == ("cam02",) and "99 bytes of pixels" in said.text and "left out" in said.text


def long_bag(change, seconds=3):
    """The first images of the room again and again, so that clocks can settle."""
    room, found = bag_room(), [m for m in bag_room().messages() if m[0] == "/tf_static"]
    for number in range(seconds * 10):
        stamp = T0 + number * STEP_NS
        for camera in room.cameras:
            at, told = change(camera.name, stamp + LATE_NS, stamp)
            found.append(
                (f"/{camera.name}/depth/image_raw", at, bags.image(room.raw[camera.name][T0], told, "x"))
            )
        found += [
            ("/joint_states", stamp + n * 20 * MS, bags.joint_state(room.joints[T0], stamp + n * 20 * MS))
            for n in range(5)
        ]
    return found


def test_stamps_ahead_of_the_clock_are_taken_back(tmp_path):
    ahead = long_bag(lambda c, at, stamp: (at, stamp + 70 * MS * (c == "cam03")))
    found, _ = played(site_of(tmp_path, ahead, max_skew_ms=100))
    snapshot, findings, clocks = found[-1]
    frame = next(frame for frame in snapshot.frames if frame.camera == "cam03")
    assert clocks["cam03"].offset_ns == -58 * MS
    # not before it came: 12 ms later than the truth, and no more
    assert frame.stamp_ns == snapshot.now_ns and frame.stamp_ns - (T0 + 29 * STEP_NS) == LATE_NS
    (said,) = findings
    assert said.about == ("cam03",) and "58 ms ahead of when its images come" in said.text and not said.stops


def test_another_clock_is_learnt_and_nothing_counts_before(tmp_path):
    other = long_bag(lambda c, at, stamp: (at, stamp - 3600 * S * (c == "cam03")))
    site = site_of(tmp_path, other)
    found, _ = played(site)
    has = ["cam03" in [f.camera for f in snapshot.frames] for snapshot, *_ in found]
    assert has[:9] == [False] * 9 and has[11:] == [True] * (len(has) - 11)
    snapshot, findings, clocks = found[-1]
    frame = next(frame for frame in snapshot.frames if frame.camera == "cam03")
    truth = T0 + 29 * STEP_NS
    bound = snapshot.clock_bounds_ns["cam03"]
    assert frame.stamp_ns - bound <= truth <= frame.stamp_ns and bound < 60 * MS
    assert clocks["cam03"].offset_ns == 3600 * S + LATE_NS
    assert (
        len(findings) == 1
        and "60 min 0 s behind that of the monitor: its stamps are moved" in findings[0].text
    )
    assert "counts once its clock is known" in found[0][1][0].text


def test_cameras_without_stamps_are_as_old_as_they_may_be(tmp_path):
    none = long_bag(lambda c, at, stamp: (at, stamp * (c != "cam03")), seconds=1)
    snapshot, _, clocks = played(site_of(tmp_path, none))[0][-1]
    assert snapshot.clock_bounds_ns["cam03"] == 50 * MS and "cam03" not in clocks
    assert snapshot.oldest_age_ms == pytest.approx(50)


def test_the_machine_is_known_or_the_bag_is_refused(tmp_path):
    messages = [m for m in bag_room().messages() if m[0] != "/joint_states"]
    with pytest.raises(Exception, match="no topic /joint_states") as caught:
        list(Played(site_of(tmp_path, messages)))
    assert isinstance(caught.value, JointsError | ValueError)
    held = dict.fromkeys(("long", "larm", "propeller", "carc"), 0.1)
    time = Time()
    site = Site.load(tmp_path / "site.yaml")
    snapshot = next(iter(Played(site, held, clock_ns=time, sleep=time.sleep)))
    assert snapshot.joints == held


def test_a_bag_without_one_image_is_refused(tmp_path):
    messages = [m for m in bag_room().messages() if "image_raw" not in m[0]]
    for camera in bag_room().cameras:
        messages.append((f"/{camera.name}/depth/image_raw", T0, ("sensor_msgs/msg/Image", b"\0\1\0\0")))
    with pytest.raises(SiteError, match="no depth image"):
        list(Played(site_of(tmp_path, messages)))


def test_a_room_with_a_bag_is_played_and_any_other_is_as_it_was(tmp_path):
    room = open_room(site_of(tmp_path, bag_room().messages()))
    assert isinstance(live(room).source, Played) and live(room).grid is room.grid
    bag_room().write_folder(tmp_path / "images")
    path = bag_room().site(tmp_path / "folder.yaml", {"layout": "folder", "folder": "images"})
    other = open_room(Site.load(path))
    assert live(other) is other


def told_speeds(messages, speeds_of):
    """The messages, of whose joints it is said how fast they are."""
    return [
        (topic, at, message if topic != "/joint_states" else replaced_speeds(message, speeds_of))
        for topic, at, message in messages
    ]


def replaced_speeds(message, speeds_of):
    object.__setattr__(message, "velocity", np.array([speeds_of(name) for name in message.name]))
    return message


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_velocities_that_another_writer_wrote_are_those_of_the_snapshot(tmp_path, storage):
    joints = next(iter(bag_room().joints.values()))
    due = {name: 0.01 * number - 0.02 for number, name in enumerate(joints)}
    silent = next(iter(joints))
    for fast, known in ((due, set(due)), ({**due, silent: math.nan}, set(due) - {silent})):
        folder = tmp_path / f"{len(known)}"
        folder.mkdir()
        messages = told_speeds(bag_room().messages(), fast.__getitem__)
        bag = bags.written(folder / "bag", messages, storage)
        site = Site.load(bag_room().site(folder / "site.yaml", bag_room().recording(bag)))
        for snapshot in (*(one[0] for one in played(site)[0]), *moments(site)):
            assert set(snapshot.velocities) == known
            assert all(abs(snapshot.velocities[name] - fast[name]) < 1e-12 for name in snapshot.velocities)


def test_without_velocities_in_a_bag_none_are_known(tmp_path):
    site = site_of(tmp_path, bag_room().messages())
    assert all(dict(one[0].velocities) == {} for one in played(site)[0])


def joints_told(late_ns, ahead_ns=0):
    """The bag, whose joints come so long after they were so, by a clock that is so much ahead."""
    found = [m for m in bag_room().messages() if m[0] != "/joint_states"]
    return found + [
        ("/joint_states", stamp + late_ns, bags.joint_state(joints, stamp + ahead_ns))
        for stamp, joints in bag_room().joints.items()
    ]


@pytest.mark.parametrize("late_ms", [0, 5, 60, 130, 250])
def test_no_joints_are_used_that_had_not_come(tmp_path, late_ms):
    site = site_of(tmp_path, joints_told(late_ms * MS))
    found, _ = played(site)
    known = 0
    for snapshot, *_ in found:
        had_come = [at for at in bag_room().joints if at + late_ms * MS <= snapshot.now_ns]
        assert (snapshot.joints is None) == (not had_come)
        if had_come:
            known += 1
            assert snapshot.joints == bag_room().joints[had_come[-1]]
            assert snapshot.joints_ns == had_come[-1]
    assert known >= 1
    said = {f.text for _, findings, _ in found for f in findings if f.kind == "clock"}
    told = {f.text for f in time_findings(site)}
    if late_ms > 100:
        assert said and f"/joint_states: joints come 0.{late_ms // 10} s after their stamps" in next(
            iter(said)
        )
        assert any("joints come" in text for text in told)
    else:
        assert not said and not told


def test_joints_ahead_of_when_they_come_are_taken_back_and_said(tmp_path):
    site = site_of(tmp_path, joints_told(MS, 200 * MS))
    found, _ = played(site)
    for snapshot, findings, _ in found:
        truth = bag_room().joints[snapshot.frames[0].stamp_ns]
        for joint, at in truth.items():
            assert snapshot.joints_of["cam00"][joint] == pytest.approx(at, abs=1e-3)
        assert snapshot.joints_ns <= snapshot.now_ns
        (said,) = findings
        assert "0.199 s ahead of when joints come" in said.text and not said.stops
    assert any("ahead of when joints come" in finding.text for finding in time_findings(site))


def test_joints_of_several_machines_are_heard_as_those_of_one(tmp_path):
    several = [{"name": "arm", "builtin": "ceiling_c_arm"}]
    room = bag_room()
    bag = bags.written(tmp_path / "bag", sorted(joints_told(MS, 200 * MS), key=lambda one: one[1]))
    room.site(tmp_path / "site.yaml", room.recording(bag), machine=None, machines=several)
    site = Site.load(tmp_path / "site.yaml")
    assert any("ahead of when joints come" in finding.text for finding in time_findings(site))
    for snapshot, *_ in played(site)[0]:
        assert snapshot.joints_ns <= snapshot.now_ns


def test_who_is_slow_waits_for_images_that_are_due_soon_and_begins_with_young_ones(tmp_path):
    messages = long_bag(lambda c, at, stamp: (at, stamp), seconds=2)
    found, _ = played(site_of(tmp_path, messages), judge_ns=150 * MS)
    behind = [snapshot.now_ns - snapshot.frames[0].stamp_ns - LATE_NS for snapshot, *_ in found]
    # half a period over when it asks: once the period is known, every second moment, the moment that it comes
    assert max(behind[:2]) >= 45 * MS and max(behind[3:]) < 5 * MS
    assert np.diff([snapshot.frames[0].stamp_ns for snapshot, *_ in found[3:]]).max() <= 2 * STEP_NS


def test_images_of_one_moment_that_come_one_behind_the_other_are_one_snapshot(tmp_path):
    late = {camera.name: 3 * MS * number for number, camera in enumerate(bag_room().cameras)}
    found, _ = played(site_of(tmp_path, long_bag(lambda c, at, stamp: (at + late[c], stamp), seconds=2)))
    settled = [snapshot for snapshot, *_ in found if snapshot.now_ns > T0 + 5 * STEP_NS]
    assert len(settled) == 15 and all(snapshot.skew_ms < 10 for snapshot in settled)
