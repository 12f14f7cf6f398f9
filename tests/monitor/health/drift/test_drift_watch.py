"""A camera that moved is named, and no other; people and pushed tables are no reason; what is found stays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import CalibrationError, InputError
from elbowroom.geometry import parallel
from elbowroom.monitor import Condition, Watch
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.sequential import Tally
from elbowroom.sensing import DepthFrame, Snapshot
from reference.watch_run_length import mean_run_length
from reference.watch_twins import CAMERAS, NOISE_M, camera_at, commissioned, frame, knocked, walls

MS = 1_000_000
REFERENCES = commissioned(CAMERAS)


def run(watch, cameras, start=0, moments=60, noise_m=NOISE_M, change=lambda frame, k: frame):
    """Lets a watch hear so many moments at 30 Hz; its last health."""
    for k in range(start, start + moments):
        stamp = k * 33 * MS
        frames = [change(frame(camera, stamp, noise_m, np.random.default_rng(k)), k) for camera in cameras]
        health = watch.hear(Snapshot.taken([f for f in frames if f is not None], None, stamp))
    return health


def test_nothing_happens_where_nothing_moves():
    health = run(Watch(CAMERAS, REFERENCES), CAMERAS)
    assert health.reason is None and health.count(Condition.STILL) == 3
    assert all(camera.share_seen > 0.9 for camera in health.cameras)


@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize(
    ("turn_deg", "move_m"),
    [((1, 0, 0), (0, 0, 0)), ((0, -1, 0), (0, 0, 0)), ((0, 0, 1), (0, 0, 0))]
    + [((0, 0, 0), (0.02, 0, 0)), ((0, 0, 0), (0, -0.02, 0)), ((0, 0, 0), (0, 0, 0.02))],
)
def test_the_knocked_camera_is_named_within_two_seconds_and_no_other(number, turn_deg, move_m):
    watch = Watch(CAMERAS, REFERENCES)
    run(watch, CAMERAS, moments=12)
    truly = [knocked(c, turn_deg, move_m) if i == number else c for i, c in enumerate(CAMERAS)]
    health = run(watch, truly, 12, 60)
    name = CAMERAS[number].name
    assert list(health.stops) == [name] and health.reason.startswith(f"camera {name} has ")
    shift = watch.shift_of(name)
    assert np.degrees(shift.turn_rad) == pytest.approx(turn_deg, abs=0.15)
    assert shift.move_m == pytest.approx(move_m, abs=0.005)


def test_the_order_of_cameras_does_not_matter():
    truly = [knocked(CAMERAS[0], (0, 1, 0)), *CAMERAS[1:]]
    one = run(Watch(CAMERAS, REFERENCES), truly)
    other = run(Watch(CAMERAS[::-1], REFERENCES[::-1]), truly[::-1])
    # cameras take turns by their place: the frames that are heard are others, what is found is not
    assert set(one.stops) == set(other.stops) == {"north"}


def test_threads_do_not_matter():
    truly = [knocked(CAMERAS[0], (0, 1, 0)), *CAMERAS[1:]]
    with parallel.threads(1):
        one = run(Watch(CAMERAS, REFERENCES), truly)
    with parallel.threads(4):
        many = run(Watch(CAMERAS, REFERENCES), truly)
    assert one.stops == many.stops
    assert [c.share_seen for c in one.cameras] == [c.share_seen for c in many.cameras]


def test_what_was_found_stays_though_the_camera_comes_back_or_gives_nothing():
    watch = Watch(CAMERAS, REFERENCES)
    found = run(watch, [knocked(CAMERAS[0], (0, 1, 0)), *CAMERAS[1:]])
    assert run(watch, CAMERAS, 100, 60).stops == found.stops
    assert watch.hear(Snapshot.taken([], None, 10**12)).stops == found.stops
    # only a watch that is made anew begins anew
    assert run(Watch(CAMERAS, REFERENCES), CAMERAS, 200, 20).reason is None


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_a_person_in_front_never_alarms(seed):
    """Upright bodies of any size walk through all images, or stand close to the walls."""
    rng = np.random.default_rng(seed)
    place, speed = rng.uniform(0, 80), rng.uniform(-2, 2)
    half, distance, top = rng.uniform(4, 25), rng.uniform(0.4, 3), rng.uniform(0, 40)

    def with_person(seen: DepthFrame, k: int) -> DepthFrame:
        v, u = np.mgrid[:60, :80]
        body = (np.abs(u - (place + speed * k) % 80) < half) & (v > top)
        depth = np.where(
            body, np.minimum(seen.depth_m, distance + rng.normal(0, 0.005, body.shape)), seen.depth_m
        )
        return DepthFrame(seen.camera, seen.stamp_ns, np.float32(depth))

    assert run(Watch(CAMERAS, REFERENCES), CAMERAS, moments=90, change=with_person).reason is None


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_furniture_that_is_pushed_is_no_camera_that_moved(seed):
    """A quarter of the image is farther or nearer than it was by some centimetres."""
    rng = np.random.default_rng(seed)
    u0, v0, push = rng.integers(0, 40), rng.integers(0, 30), rng.uniform(0.02, 0.3) * rng.choice((-1, 1))

    def pushed(seen: DepthFrame, k: int) -> DepthFrame:
        depth = seen.depth_m.copy()
        depth[v0 : v0 + 30, u0 : u0 + 40] += np.float32(push)
        return DepthFrame(seen.camera, seen.stamp_ns, depth)

    assert run(Watch(CAMERAS, REFERENCES), CAMERAS, change=pushed).reason is None


def test_a_camera_that_is_turned_far_is_named_too():
    health = run(Watch(CAMERAS, REFERENCES), [knocked(CAMERAS[0], (0, 25, 0)), *CAMERAS[1:]])
    assert list(health.stops) == ["north"]


def test_a_frame_that_is_heard_twice_counts_once():
    watch = Watch(CAMERAS[:1], REFERENCES[:1])
    moved = frame(knocked(CAMERAS[0], (0, 1, 0)), 5, NOISE_M)
    for _ in range(100):
        assert watch.hear(Snapshot.taken([moved], None, 5)).reason is None


def test_fewer_frames_find_less_but_never_something_else():
    truly = [knocked(CAMERAS[0], (0, 1, 0)), *CAMERAS[1:]]

    def lost(seen: DepthFrame, k: int) -> DepthFrame | None:
        return None if k % 3 else seen

    health = run(Watch(CAMERAS, REFERENCES), truly, moments=180, change=lost)
    assert list(health.stops) == ["north"]
    assert watch_of_nothing().count(Condition.SILENT) == 3


def watch_of_nothing():
    return Watch(CAMERAS, REFERENCES).hear(Snapshot.taken([], None, 0))


def test_a_camera_that_sees_one_wall_says_which_motions_it_cannot_tell():
    facing = camera_at("facing", (-1.0, 0.0, 1.4), (2.3, 0.0, 1.4), size=(80, 60))
    room = Commissioning([facing], None, 6)
    depth = np.full((60, 80), 3.3)
    for number in range(6):
        room.add(Snapshot.taken([frame(facing, number, NOISE_M, depth=depth)]))
    reference = room.reference_of(facing)
    assert reference.unseen_motions(0.007, 0.008) == (
        "rolling about its line of sight",
        "moving sideways",
        "moving up and down",
    )
    # and what it cannot tell it does not claim
    sideways = frame(facing, 1, NOISE_M, depth=depth)
    watch = Watch([facing], [reference])
    for k in range(60):
        health = watch.hear(Snapshot.taken([DepthFrame("facing", k, sideways.depth_m)], None, k))
    assert health.reason is None


def test_what_a_person_hid_for_a_while_is_not_in_the_reference_as_a_person():
    camera = CAMERAS[0]
    room = Commissioning([camera], None, 10)
    for number in range(10):
        depth = walls(camera)
        if number < 3:
            depth[:, 20:40] = 1.0
        depth[:, 60:] = 1.5 + 0.1 * number
        room.add(Snapshot.taken([frame(camera, number, NOISE_M, depth=depth)]))
    reference = room.reference_of(camera)
    truth, column = walls(camera).ravel()[reference.pixel], reference.pixel % 80
    assert np.abs(reference.depth_m - truth).max() < 0.025
    assert ((column >= 20) & (column < 40)).any() and not (column >= 60).any()


def test_commissioning_refuses_what_it_cannot_use():
    with pytest.raises(CalibrationError, match="at least 5"):
        Commissioning(CAMERAS, None, 3)
    with pytest.raises(CalibrationError, match="GB"):
        Commissioning([camera_at(size=(4000, 3000))], None, 200)
    room = Commissioning(CAMERAS, None, 5)
    with pytest.raises(CalibrationError, match="gave 0 frames"):
        room.references()
    with pytest.raises(CalibrationError, match="another size"):
        room.add(Snapshot.taken([DepthFrame("north", 0, np.ones((2, 2), np.float32))]))
    for number in range(5):
        room.add(Snapshot.taken([frame(CAMERAS[0], number, depth=np.zeros((60, 80)))]))
    with pytest.raises(CalibrationError, match="0 flat spots"):
        room.reference_of(CAMERAS[0])


def test_references_of_another_site_are_refused():
    with pytest.raises(CalibrationError, match="lacks camera low"):
        Watch(CAMERAS, REFERENCES[:2])
    with pytest.raises(CalibrationError, match="has camera low"):
        Watch(CAMERAS[:2], REFERENCES)
    with pytest.raises(CalibrationError, match="twice"):
        Watch(CAMERAS, [*REFERENCES, REFERENCES[0]])
    with pytest.raises(CalibrationError, match=r"80x60.*40x30"):
        Watch([camera_at("north", size=(40, 30))], REFERENCES[:1])
    with pytest.raises(CalibrationError, match="radial"):
        Watch([camera_at("north", depth_kind="radial")], REFERENCES[:1])


def test_a_frame_of_another_size_is_an_error_and_no_silence():
    with pytest.raises(InputError, match="2 x 2 pixels"):
        Watch(CAMERAS, REFERENCES).hear(
            Snapshot.taken([DepthFrame("north", 0, np.ones((2, 2), np.float32))], None, 0)
        )


@given(st.lists(st.sampled_from([True, False, None]), max_size=80), st.integers(1, 20))
def test_a_tally_never_falls_back_once_it_decided(says, limit):
    tally, score = Tally(limit), 0
    for said in says:
        was = tally.decided
        tally.add(said)
        if not was and said is not None:
            score = score + 1 if said else max(score - 2, 0)
        assert tally.score == score and tally.decided == (score >= limit) and (tally.decided or not was)


@pytest.mark.parametrize(("limit", "share"), [(1, 0.3), (3, 0.5), (5, 0.6)])
def test_the_mean_run_length_is_that_of_many_runs(limit, share):
    rng = np.random.default_rng(1)
    runs = []
    for _ in range(4000):
        tally, frames = Tally(limit), 0
        while not tally.decided:
            tally.add(bool(rng.random() < share))
            frames += 1
        runs.append(frames)
    assert np.mean(runs) == pytest.approx(
        mean_run_length(limit, share), rel=5 * np.std(runs) / 4000**0.5 / np.mean(runs)
    )
