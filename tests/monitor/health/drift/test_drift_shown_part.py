"""A camera before two upright walls: it does not show up and down, and is named for what it does show."""

import numpy as np
import pytest

from elbowroom.monitor import Condition, Tolerance, Watch
from elbowroom.monitor.health.drift.shown_part import ShownPart
from elbowroom.sensing import Snapshot
from reference.watch_twins import NOISE_M, camera_at, commissioned, frame, knocked, walls

TOLERANCE = Tolerance()
# nothing but the corner where two walls meet, from near, looking up by a quarter of a right angle
CORNER = camera_at("corner", (1.75, 1.4, 1.0), (2.3, 2.0, 1.25), size=(80, 60))
OPEN = camera_at("open", (-1.9, 0.2, 2.3), (0.6, -0.2, 0.6))
(REFERENCE,) = commissioned([CORNER], 0.001)
UP = CORNER.world_from_camera[:3, :3].T @ (0.0, 0.0, 1.0)
LEVEL = np.cross(UP, (0.0, 0.0, 1.0)) / np.linalg.norm(np.cross(UP, (0.0, 0.0, 1.0)))


def heard(move_m, moments=60):
    watch = Watch([CORNER], [REFERENCE])
    for k in range(moments):
        truly = knocked(CORNER, (0, 0, 0), move_m) if k >= 12 else CORNER
        seen = frame(truly, k * 33_000_000, 0.001, np.random.default_rng(k))
        health = watch.hear(Snapshot.taken([seen], None, k * 33_000_000))
    return health, watch.shift_of("corner")


def test_the_view_of_the_corner_does_not_show_one_direction_and_that_of_the_room_all():
    part = ShownPart.of(REFERENCE, TOLERANCE)
    assert part is not None and part.names == ("moving up and down",) and len(part.across) == 1
    hidden = np.linalg.pinv(part.across)[3:, 0]
    assert abs(hidden @ UP) / np.linalg.norm(hidden) > 0.99
    assert ShownPart.of(commissioned([OPEN], NOISE_M)[0], TOLERANCE) is None


def test_a_move_that_is_not_shown_leaves_the_image_as_it_is():
    moved = walls(knocked(CORNER, (0, 0, 0), tuple(0.02 * UP)))
    assert np.abs(moved - walls(CORNER)).max() < 1e-9
    health, shift = heard(tuple(0.02 * UP))
    assert health.reason is None and shift is None and health.cameras[0].condition is Condition.STILL


@pytest.mark.parametrize("sign", [1, -1])
def test_a_move_of_2_cm_along_y_is_named_by_the_part_that_is_shown(sign):
    health, shift = heard((0.0, sign * 0.02, 0.0))
    assert list(health.stops) == ["corner"]
    assert "may be a part of it: its view does not show moving up and down" in health.reason
    shown = np.array((0.0, sign * 0.02, 0.0)) - sign * 0.02 * UP[1] * UP
    assert shift.move_m == pytest.approx(shown, abs=0.001)
    assert 4 < shift.move_mm < 12


def test_a_camera_that_sees_all_is_not_named_for_so_little():
    watch, references = None, commissioned([OPEN], 0.001)
    watch = Watch([OPEN], references)
    for k in range(60):
        truly = knocked(OPEN, (0, 0, 0), (0.0, 0.0, 0.006))
        health = watch.hear(Snapshot.taken([frame(truly, k, 0.001, np.random.default_rng(k))], None, k))
    assert health.reason is None


def test_a_far_wall_keeps_the_whole_tolerance_and_a_near_one_a_third():
    for distance, share in ((0.6, 1 / 3), (2.4, 0.6), (4.0, 1.0)):
        facing = camera_at("facing", (2.3 - distance, 0.0, 1.4), (2.3, 0.0, 1.4), size=(80, 60))
        depth = np.full((60, 80), distance)
        reference = _reference(facing, depth)
        part = ShownPart.of(reference, TOLERANCE)
        assert part.tolerance.move_m == pytest.approx(share * TOLERANCE.move_m, rel=0.02)
        assert part.tolerance.turn_rad == pytest.approx(share * TOLERANCE.turn_rad, rel=0.02)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_left_is_the_fit_with_nothing_in_the_hidden_directions(seed):
    """Beside a twin: least squares with a strong prior at zero there."""
    random = np.random.default_rng(seed)
    part = ShownPart.of(REFERENCE, TOLERANCE)
    jacobian = random.normal(size=(40, 6)) * (1, 1, 1, 3, 3, 3)
    information = jacobian.T @ jacobian * 1e6
    motion = random.normal(0, 0.01, 6)
    held = information + 1e6 * np.linalg.norm(information) * part.across.T @ part.across
    wanted = np.linalg.solve(held, information @ motion)
    shift = part.shift(motion, np.linalg.inv(information))
    assert np.concatenate([shift.turn_rad, shift.move_m]) == pytest.approx(wanted, abs=1e-6)
    assert shift.covariance - part.steady == pytest.approx(np.linalg.inv(held), abs=1e-9)


def _reference(camera, depth):
    from elbowroom.monitor.health.drift.commission import Commissioning

    room = Commissioning([camera], None, 6)
    for number in range(6):
        room.add(Snapshot.taken([frame(camera, number, 0.001, depth=depth)]))
    return room.reference_of(camera)
