import numpy as np
import pytest

from elbowroom.errors import InputError, MachineError
from elbowroom.simulate import InterventionRoom, true_occupancy
from elbowroom.simulate.person import GAIT_PHASES, Person, Stance, Walk
from elbowroom.simulate.room import REACH, STAFF
from reference import simulate_truth as naive


def names(room, **kinds):
    return {
        solid.name for solid in room.at(0.0).solids if all(getattr(solid, k) == v for k, v in kinds.items())
    }


def test_every_solid_is_closed_and_its_faces_look_outwards(room):
    for solid in room.at(2.0).solids:
        a, b, c = (solid.mesh.vertices[solid.mesh.faces[:, corner]] for corner in range(3))
        assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0, solid.name
        far_away = solid.mesh.vertices.max(axis=0) + np.array([0.3, 0.2, 0.1])
        assert naive.winding(solid.mesh.vertices[solid.mesh.faces], far_away) == 0, solid.name
        edges = solid.mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        there, back = np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0)
        assert (there == back).all(), solid.name


def test_nobody_walks_into_anything_and_the_course_touches_nothing(room, grid):
    coarse = grid.covering(grid.lower_m, grid.upper_m, 0.08)
    for time_s in np.arange(0, 400, 13.7):
        moment = room.at(time_s)
        truth = true_occupancy(coarse, moment)
        assert not (truth.occupied & truth.machine).any(), time_s
        corners = [
            solid.vertices_in_world for solid in moment.moving_solids if solid.name in {p.name for p in STAFF}
        ]
        for number, mine in enumerate(corners):
            assert mine[:, 2].min() >= 0
            assert np.abs(mine[:, :2]).max() < 2
            for others in corners[number + 1 :]:
                apart = np.maximum(
                    mine.min(axis=0) - others.max(axis=0), others.min(axis=0) - mine.max(axis=0)
                )
                assert apart.max() > 0.05, time_s


def test_people_touch_no_furniture(room, grid):
    fine = grid.covering(grid.lower_m, grid.upper_m, 0.02)
    empty = InterventionRoom(furniture=False)
    furniture = true_occupancy(fine, InterventionRoom(staff=()).at(0.0)).occupied
    for time_s in np.arange(0, 30, 1.9):
        assert not (true_occupancy(fine, empty.at(time_s)).occupied & furniture).any(), time_s


def test_course_stays_below_full_speed(room):
    full = {"long": 0.15, "larm": np.radians(12), "propeller": np.radians(25), "carc": np.radians(25)}
    times = np.arange(0, 200, 0.1)
    for name, speed in full.items():
        positions = np.array(
            [room.at(t, people=[p.walk.at(0) for p in STAFF]).joints[name] for t in times[::5]]
        )
        assert np.abs(np.diff(positions)).max() / 0.5 <= speed
        assert np.ptp(positions) > 0.3


def test_walk_is_closed_and_looks_where_it_goes():
    walk = Walk((1.0, 0.5), (0.4, 0.2), 10.0)
    here, later = walk.at(3.0), walk.at(13.0)
    assert (later.x_m, later.y_m) == pytest.approx((here.x_m, here.y_m))
    step = walk.at(3.001)
    assert np.arctan2(step.y_m - here.y_m, step.x_m - here.x_m) == pytest.approx(here.heading_rad, abs=1e-2)


def test_people_share_one_mesh_for_each_phase_of_their_stride():
    person = Person("someone", Walk((0, 0), (1, 1), 9.0))
    meshes = {id(person.solids(person.walk.at(t))[0].mesh) for t in np.arange(0, 9, 0.05)}
    assert 2 < len(meshes) <= GAIT_PHASES
    assert all(len(solid.mesh.faces) <= 1600 for solid in person.solids(Stance(0, 0, 0)))


def test_parts_of_the_room_can_be_left_out(room):
    everything = names(room)
    assert {
        "doctor",
        "nurse 1",
        "nurse 2",
        "patient",
        "table",
        "lamp",
        "monitors",
        "c_arc",
        "floor",
    } <= everything
    assert sum(name.startswith("cabinet") for name in everything) == 3
    alone = InterventionRoom(people=False, furniture=False)
    walls = {"floor", "ceiling", "wall -x", "wall +x", "wall -y", "wall +y"}
    assert names(alone, is_machine=False) == walls
    assert names(alone, is_machine=True) == names(room, is_machine=True)
    assert "patient" not in names(InterventionRoom(people=False))
    assert "table" in names(InterventionRoom(people=False))


def test_walls_lie_outside_the_grid(grid):
    assert not true_occupancy(grid, InterventionRoom(people=False, furniture=False).at(0.0)).occupied.any()


def test_chosen_poses_are_taken(room):
    joints = {"long": 0.1, "larm": -0.2, "propeller": 0.3, "carc": 0.0}
    stances = [Stance(1.0, 1.0, 0.0), Stance(1.0, -1.0, 0.0), Stance(-1.5, -1.0, 1.0)]
    moment = room.at(0.0, joints=joints, people=stances)
    assert moment.joints == joints
    nurse = next(solid for solid in moment.solids if solid.name == "nurse 2")
    assert nurse.world_from_solid[:2, 3].tolist() == [-1.5, -1.0]


def test_wrong_number_of_people_and_wrong_joints_are_refused(room):
    with pytest.raises(InputError, match="1 people placed, this room has 3"):
        room.at(0.0, people=[Stance(0, 0, 0)])
    with pytest.raises(MachineError, match="larm"):
        room.at(0.0, joints={"long": 0.0, "larm": 9.0, "propeller": 0.0, "carc": 0.0})


def test_random_moment_can_be_repeated_and_touches_nothing(room, grid):
    first = [room.random_moment(rng) for rng in [np.random.default_rng(7)] for _ in range(4)]
    again = [room.random_moment(rng) for rng in [np.random.default_rng(7)] for _ in range(4)]
    assert [m.joints for m in first] == [m.joints for m in again]
    assert len({m.joints["larm"] for m in first}) == 4
    for moment in first:
        truth = true_occupancy(grid.covering(grid.lower_m, grid.upper_m, 0.04), moment)
        assert not (truth.occupied & truth.machine).any()
        checked = [s for s in moment.solids if s.is_machine and s.name in room.machine.checked_links]
        for solid in checked:
            assert grid.contains(solid.vertices_in_world).all()
    assert set(REACH) == set(room.machine.joint_names)
