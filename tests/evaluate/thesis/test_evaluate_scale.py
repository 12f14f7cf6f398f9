"""The scale model: its motions beside the truth, and which voxels of their ways are in view."""

import itertools

import numpy as np
import pytest

import elbowroom as er
from elbowroom.evaluate.shares.task import Settings
from elbowroom.evaluate.thesis.due import due_table
from elbowroom.evaluate.thesis.part import Part
from elbowroom.geometry import bits, looking_at
from elbowroom.machine import body_words
from elbowroom.simulate import Moment, Solid
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.shapes import box, join

pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
from elbowroom.evaluate.thesis.scale import PART, SENSORS, judge_pose, near_m, with_noise
from elbowroom.evaluate.thesis.scale_model import (
    PLACES_M,
    VOXEL_SIZES_M,
    body_growth,
    kinect,
    model_grid,
    model_machine,
    model_motions,
    model_pose,
)
from elbowroom.evaluate.thesis.way_view import WayView

EDGE_M = 0.004
EDGES_M = (EDGE_M, 0.006)
JOINTS = {"long": 0.0, "larm": 0.0, "propeller": 0.0, "carc": 0.0}


def wall(lower, upper):
    return Solid("wall", join([box(lower, upper)]), np.eye(4))


def view_of(*solids):
    machine = model_machine()
    moment = Moment(0.0, (*solids, *link_solids(machine, JOINTS)), JOINTS)
    return WayView(machine, moment, model_grid(EDGE_M))


@pytest.fixture(scope="module")
def rows():
    return judge_pose(1, EDGES_M, False).rows


def test_no_motion_goes_farther_than_the_truth(rows):
    assert rows
    for row in rows:
        assert row["free_travel"] <= row["truth_travel"] + 1e-6 and not row["more_than_truth"]


def test_every_motion_is_judged_by_every_sensor_and_its_view_is_the_same_for_all(rows):
    motions = {row["motion"] for row in rows}
    assert len(rows) == len(motions) * len(SENSORS) * len(EDGES_M)
    for motion, edge in itertools.product(motions, EDGES_M):
        mine = [row for row in rows if (row["motion"], row["voxel_size_m"]) == (motion, edge)]
        assert len({(row["in_view"], row["travel_in_view"]) for row in mine}) == 1


def test_a_way_is_in_view_where_what_is_hidden_lies_near_the_contact(rows):
    assert [near_m(edge) for edge in (0.002, 0.0025, 0.004)] == [0.005, 0.005, 0.008]
    for row in rows:
        hidden_mm = row["short_mm"] - row["short_of_view_mm"]
        assert row["in_view"] == (hidden_mm <= 1000 * near_m(row["voxel_size_m"]) + 1e-3)


def test_exact_images_let_a_motion_go_as_far_as_its_way_is_in_view(rows):
    exact = [row for row in rows if not row["noise"]]
    assert any(row["free_travel"] > 0 for row in exact)
    assert all(row["short_of_view_mm"] <= 1000 * row["voxel_size_m"] for row in exact)


def test_noise_is_that_of_the_model_and_makes_no_return_of_none():
    depth = np.full((480, 640), 0.9, dtype=np.float32)
    depth[:10] = 0
    frame = er.DepthFrame("one", 0, depth)
    camera = kinect("one", (0.9, 0.0, 0.22), True)
    assert (with_noise(kinect("one", (0.9, 0.0, 0.22), False), frame, [1]).depth_m == depth).all()
    noisy = with_noise(camera, frame, [1]).depth_m
    assert (noisy[:10] == 0).all()
    # Nguyen 2012: 1.2 mm + 1.9 mm/m^2 (0.9 m - 0.4 m)^2
    assert np.std(noisy[10:]) == pytest.approx(0.0012 + 0.0019 * 0.25, rel=0.01)
    assert np.mean(noisy[10:]) == pytest.approx(0.9, abs=1e-4)


def test_summary_adds_up_and_answers_what_was_due(rows):
    assert isinstance(PART, Part)
    summaries = PART.summary(rows)
    of = ("voxel_size_m", "noise", "losses")
    kinds = [(edge, *sensor) for edge in EDGES_M for sensor in SENSORS]
    assert [tuple(row[name] for name in of) for row in summaries] == kinds
    for row in summaries:
        mine = [r for r in rows if all(r[name] == row[name] for name in of)]
        assert row["motions"] == len(mine)
        assert row["in_view"] == sum(r["in_view"] for r in mine)
        assert row["worst_short_mm"] == max(r["short_mm"] for r in mine)
    table = due_table([PART], [{"part": "scale", **row} for row in rows + summaries])
    assert table is not None and len(table.lines) == 3


def test_a_pose_is_the_same_each_time_and_its_motions_reach_five_braking_distances():
    joints, met = model_pose(3)
    assert joints == model_pose(3)[0]
    assert all(motion.looked_at == pytest.approx(5 * motion.braking_distance) for motion in met)
    assert all(0 < contact.travel < motion.looked_at for motion, contact in met.items())


def test_tasks_are_one_for_each_pose_and_take_voxel_sizes_at_full_scale():
    tasks = PART.tasks(Settings(voxel_sizes_m=(0.05, 0.02)))
    assert len({task.name for task in tasks}) == len(tasks)
    assert all(task.arguments["voxel_sizes_m"] == pytest.approx([0.01, 0.004]) for task in tasks)


def test_nothing_hides_a_voxel_in_the_open_and_a_wall_hides_what_lies_behind_it():
    camera = kinect("one", (0.9, 0.0, 0.22), False)
    centres = np.array([(0.32, 0.0, 0.22), (0.32, 0.05, 0.22)])
    assert view_of().seen_by(camera, centres).all()
    hiding = wall((0.35, 0.02, 0.1), (0.36, 0.08, 0.3))
    assert view_of(hiding).seen_by(camera, centres).tolist() == [True, False]


def test_a_wall_that_ends_within_half_a_pixel_of_a_voxel_hides_it():
    camera = kinect("one", (0.9, 0.0, 0.22), False)
    # seen from the camera, the voxel's nearer face ends at y = 0.002 m
    centre = np.array([(0.32, 0.0, 0.22)])
    beside = 0.002 * 0.545 / 0.578
    for gap_px, seen in ((0.2, False), (1.2, True)):
        edge = beside + gap_px * 0.545 / camera.intrinsics.fx
        hiding = wall((0.35, edge, 0.1), (0.36, 0.2, 0.3))
        assert view_of(hiding).seen_by(camera, centre)[0] == seen


@pytest.mark.parametrize(
    "place", [(0.5, 0.0, 0.22), (0.9, 0.0, 5.0)], ids=["nearer than the sensor measures", "out of the image"]
)
def test_what_is_out_of_range_or_image_is_not_in_view(place):
    camera = er.DepthCamera(
        name="one",
        width=640,
        height=480,
        world_from_camera=looking_at(place, (0.0, 0.0, place[2])),
        intrinsics=er.Intrinsics(fx=589, fy=589, cx=319.5, cy=239.5),
        min_depth_m=0.5,
        max_depth_m=4.0,
    )
    assert not view_of().seen_by(camera, np.array([(0.32, 0.0, 0.22)])).any()


def test_a_way_leaves_out_the_body_and_grows_with_the_travel():
    view = view_of()
    motion = next(m for m in model_motions(model_machine()) if m.name == "long +")
    near, far = (view.way(motion, length) for length in (0.01, 0.02))
    assert 0 < len(near.centres) < len(far.centres)
    assert (far.travel >= 0).all() and far.travel.max() <= 0.02
    assert len(np.unique(far.centres, axis=0)) == len(far.centres)
    assert len(view.way(motion, 0.0).centres) == 0 and len(view.way(motion, -0.01).centres) == 0


def test_more_cameras_never_see_less_of_a_way_and_none_see_nothing():
    view = view_of()
    motion = next(m for m in model_motions(model_machine()) if m.name == "larm +")
    way = view.way(motion, 0.1)
    cameras = [kinect(str(n), place, False) for n, place in enumerate(PLACES_M)]
    travels = [view.travel_in_view(way, cameras[:count], 0.1) for count in range(len(cameras) + 1)]
    assert travels == sorted(travels) and travels[0] == way.travel.min() and travels[-1] <= 0.1


def test_the_body_takes_the_same_space_whatever_the_voxels_and_reaches_no_farther():
    # turned against the voxels, or faces along them count whole layers
    joints, space = model_pose(5)[0], {}
    assert body_growth(EDGE_M) == pytest.approx(EDGE_M / 2)
    for edge in VOXEL_SIZES_M:
        assert body_growth(edge) >= edge / 2
        assert body_growth(edge) + np.sqrt(3) * edge <= body_growth(EDGE_M) + np.sqrt(3) * EDGE_M + 1e-9
        grid = model_grid(edge)
        body = body_words(model_machine(), joints, grid, body_growth(edge))
        space[edge] = bits.unpack(body, grid).sum() * edge**3
    assert all(volume == pytest.approx(space[EDGE_M], rel=0.01) for volume in space.values())
