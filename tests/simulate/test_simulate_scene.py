"""Rooms in use: machines that touch nothing, people who walk where there is room."""

import itertools

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.simulate import Solid
from elbowroom.simulate.crowd import Floor
from elbowroom.simulate.floor import floor_height
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.postures import Postures
from elbowroom.simulate.scene import Course, Surroundings, scene_in
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.swing import Swing
from elbowroom.simulate.taken import Taken, fine_grid

LINK = """<link name="{}"><collision><origin xyz="0 0 {}"/><geometry><box size="{}"/></geometry></collision></link>"""
FOOT, TURRET = LINK.format("foot", 0.03, "0.2 0.2 0.06"), LINK.format("turret", 0.05, "0.16 0.16 0.1")
ARM = """<joint name="pan" type="continuous"><parent link="foot"/><child link="turret"/>
    <origin xyz="0 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="lift" type="revolute"><parent link="turret"/><child link="arm"/><origin xyz="0 0 0.1"/>
    <axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>"""
HAND = """<joint name="elbow" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="0.08 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-3.1" upper="3.1" effort="1" velocity="1"/></joint>"""
BOX = VoxelGrid.covering((-1.5, -1.5, 0.5), (1.5, 1.5, 2.3), 0.05)
NOBODY = np.zeros((0, 3))
FLOOR = Floor(np.array([-1.8, -1.8]), np.array([1.8, 1.8]), 0.0)


def static(name, lower, upper):
    return Solid(name, join([box(lower, upper)]), np.eye(4), is_static=True)


TABLE = static("table", (-0.5, -0.5, 0.7), (0.5, 0.5, 0.75))
ROOM = (static("floor", (-3, -3, -0.1), (3, 3, 0.0)), TABLE)


def arm_on(tmp_path, height=0.75, more=""):
    """An arm whose turret begins as low as its foot: both touch what the foot stands on."""
    path = tmp_path / "arm.urdf"
    arm = LINK.format("arm", 0.25, "0.08 0.08 0.5")
    path.write_text(f'<robot name="arm">{FOOT}{TURRET}{arm}{ARM}{more}</robot>')
    base = np.eye(4)
    base[2, 3] = height
    return Machine.from_urdf(path, world_from_base=base)


def postures(machine, solids=ROOM):
    return Postures(machine, Taken.of(fine_grid(BOX.lower_m, BOX.upper_m), solids), BOX)


def test_what_stands_on_a_table_does_not_stand_in_it(tmp_path):
    upright = {"pan": 0.0, "lift": 0.0}
    assert postures(arm_on(tmp_path)).trouble(upright) is None
    assert "turret stands in table" in postures(arm_on(tmp_path, height=0.70)).trouble(upright)
    assert "arm stands in table" in postures(arm_on(tmp_path)).trouble({"pan": 0.0, "lift": 2.0})


def test_a_link_that_leaves_the_box_is_said():
    machine = ceiling_c_arm()
    low = Postures(machine, Taken.of(BOX, ()), VoxelGrid.covering((-2, -2, 0), (2, 2, 0.5), 0.1))
    assert "leaves the watched box" in low.trouble(machine.nearest_to_zero())


def test_poses_that_are_drawn_touch_nothing_and_an_impossible_room_says_what_is_in_the_way(tmp_path):
    free = postures(arm_on(tmp_path))
    drawn = [free.drawn(np.random.default_rng(seed)) for seed in range(5)]
    assert all(free.trouble(joints) is None for joints in drawn)
    assert len({joints["lift"] for joints in drawn}) == 5
    walled = postures(arm_on(tmp_path), (*ROOM, static("block", (-1, -1, 0.9), (1, 1, 2.2))))
    with pytest.raises(InputError, match="most often arm stands in block"):
        walled.drawn(np.random.default_rng(0), tries=20)


def test_a_machine_does_not_stand_in_itself(tmp_path):
    machine = arm_on(tmp_path, 0.0, LINK.format("hand", 0.28, "0.06 0.06 0.56") + HAND)
    free = Postures(machine, Taken.of(VoxelGrid.covering((-1, -1, 0), (1, 1, 1.3), 0.02), ()))
    assert free.trouble({"pan": 0.0, "lift": 0.0, "elbow": 2.2}) is None
    folded = free.trouble({"pan": 0.0, "lift": 0.0, "elbow": -3.09})
    assert folded is not None and "another link of it" in folded


@pytest.mark.parametrize("share", [0.0, 0.3, 0.77])
def test_a_swing_stays_within_limits_and_half_the_speed(tmp_path, share):
    machine = ceiling_c_arm()
    joint = machine.joint("larm")
    middle = machine.nearest_to_zero() | {"larm": joint.lower + share * (joint.upper - joint.lower)}
    swing = Swing.about(machine, middle, {"larm": 0.2})
    times = np.linspace(0, 60, 601)
    values = np.array([swing.at(time_s)["larm"] for time_s in times])
    assert swing.at(0.0) == pytest.approx(middle)
    assert joint.lower - 1e-9 <= values.min() and values.max() <= joint.upper + 1e-9
    assert np.abs(np.diff(values)).max() <= 0.1 * 0.1 + 1e-9
    for time_s in times[::60]:
        machine.checked(swing.at(time_s))


def surroundings(solids=ROOM, eyes=NOBODY, floor=FLOOR):
    return Surroundings(BOX, solids, (), floor, eyes)


def test_people_walk_past_and_touch_neither_room_nor_machine_nor_cameras(tmp_path):
    machine, times = arm_on(tmp_path), tuple(100 + np.arange(20) / 5)
    eye = np.array([[0.8, 0.0, 1.3]])
    scene = scene_in(surroundings(eyes=eye), machine, Course(times, {"pan": 0.0, "lift": 0.6}, people=2))
    assert not scene.notes
    grid = VoxelGrid.covering((-2, -2, 0.02), (2, 2, 2.0), 0.04)
    nearest = []
    for time_s in times:
        moment = scene.at(time_s)
        bodies = [s for s in moment.solids if s.name.startswith("person")]
        assert len(bodies) == 4
        others = [s for s in moment.solids if s not in bodies]
        assert not any(Taken.of(grid, others).meets(body) for body in bodies)
        for one, other in itertools.combinations([b for b in bodies if "hair" not in b.name], 2):
            assert not Taken.of(grid, [one]).meets(other)
        corners = np.concatenate([body.vertices_in_world for body in bodies])
        assert np.linalg.norm(corners - eye, axis=1).min() > 0.1
        machine_m = np.concatenate([s.vertices_in_world for s in moment.solids if s.is_machine])
        first = bodies[0].vertices_in_world
        nearest.append(np.linalg.norm(first[:, None, :2] - machine_m[None, :, :2], axis=2).min())
    # nearest after two thirds of the time, and then within an arm's length
    assert 0.4 < np.argmin(nearest) / len(times) < 0.95 and min(nearest) < 0.6
    assert min(body.vertices_in_world[:, 2].min() for body in bodies) == pytest.approx(0.0, abs=0.05)


def test_where_there_is_no_room_for_people_it_is_said(tmp_path):
    tight = Floor(np.array([-0.6, -0.6]), np.array([0.6, 0.6]), 0.0)
    with pytest.raises(InputError, match="people: no way for 1"):
        scene_in(
            surroundings(floor=tight),
            arm_on(tmp_path),
            Course((1.0, 2.0), {"pan": 0.0, "lift": 0.0}, people=1),
        )


def test_a_pose_that_stands_in_something_is_noted(tmp_path):
    scene = scene_in(surroundings(), arm_on(tmp_path), Course((1.0,), {"pan": 0.0, "lift": 2.0}, moves=False))
    assert "arm stands in table" in scene.notes[0]


def test_a_machine_that_cannot_swing_stands_still_and_says_so(tmp_path):
    close = static("shelf", (-0.4, -0.4, 1.36), (0.4, 0.4, 1.4))  # a centimetre above the upright arm
    walls = [static(f"wall {n}", (x, -0.3, 0.86), (x + 0.05, 0.3, 1.34)) for n, x in enumerate((-0.11, 0.06))]
    around = surroundings((*ROOM, close, *walls))
    scene = scene_in(around, arm_on(tmp_path), Course((1.0, 2.0, 3.0, 4.0), {"pan": 0.0, "lift": 0.0}))
    lifts = [scene.at(time_s).joints["lift"] for time_s in (1.0, 2.0, 3.0)]
    assert np.ptp(lifts) < 0.06
    assert all(link.name for link in link_solids(scene.machine, scene.at(2.0).joints))


@pytest.mark.parametrize(("top", "due"), [(0.0, 0.0), (-0.13, -0.13), (0.3, 0.3)])
def test_the_floor_is_where_most_of_the_box_begins_to_be_empty(top, due):
    grid = VoxelGrid.covering((-1, -1, 0), (1, 1, 2), 0.1)
    floor = static("floor", (-3, -3, top - 0.2), (3, 3, top))
    assert floor_height(grid, [floor, static("table", (-0.2, -0.2, 0.7), (0.2, 0.2, 0.75))]) == pytest.approx(
        due
    )
    assert floor_height(grid, [TABLE]) == 0.0
