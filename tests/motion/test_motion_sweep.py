import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import maximum_filter

from elbowroom.geometry import bits
from elbowroom.motion import JointPath, Motion
from elbowroom.motion import sweep as swept
from elbowroom.motion.course import way_of
from elbowroom.motion.kernels.triangles import triangle_meets_box
from elbowroom.motion.kernels.volume import meets_block, meets_voxel
from elbowroom.motion.skin import skin_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference import motion_sweep as naive
from reference.motion_machines import HOME, nothing_in, room, touched_by_ball, touched_by_box

MOTIONS = (
    Motion("slide", 1, 0.1),
    Motion("turn", -1, 0.2),
    Motion("nod", 1, 0.2),
    JointPath([{"slide": 0.2, "turn": 0.3}, {"nod": 0.5, "turn": -0.4}], 0.1),
)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


@pytest.mark.parametrize("shape", [(16, 16, 16), (17, 5, 33), (3, 20, 50)])
def test_blocked_is_every_voxel_of_the_grid_that_is_not_free(shape):
    grid = room(0.1, lower=(0, 0, 0), upper=np.array(shape) * 0.1)
    occupied = np.random.default_rng(0).random(shape) < 0.01
    space = FreeSpace.from_occupied(grid, occupied)
    volume = swept.volume_of(space)
    np.testing.assert_array_equal(volume.words, space.blocked_words)
    np.testing.assert_array_equal(volume.cubes, (volume.words.reshape(-1, 64) != 0).any(axis=1))


@pytest.mark.parametrize("shape", [(16, 16, 16), (17, 5, 33), (40, 20, 50)])
def test_a_corner_is_blocked_where_any_of_the_eight_voxels_about_it_is(shape):
    grid = room(0.1, lower=(0, 0, 0), upper=np.array(shape) * 0.1)
    occupied = np.random.default_rng(0).random(shape) < 0.01
    corners = bits.unpack(swept.volume_of(FreeSpace.from_occupied(grid, occupied)).corners, grid)
    np.testing.assert_array_equal(corners, maximum_filter(occupied, size=2, origin=0, mode="constant"))


def test_balls_meet_the_voxels_that_they_touch():
    grid = room(0.1, lower=(-1, 0, 2), upper=(1.1, 1.7, 3.9))
    rng = np.random.default_rng(1)
    occupied = rng.random(grid.shape) < 0.003
    volume, cells = swept.volume_of(FreeSpace.from_occupied(grid, occupied)), bits.lattice(grid)
    met = 0
    for centre in rng.uniform(grid.lower_m - 0.1, grid.upper_m + 0.1, (400, 3)):
        radius = float(rng.choice([0.0, 0.03, 0.12, 0.4]))
        truth = naive.ball_meets(occupied, grid, centre, radius)
        assert meets_voxel(volume.words, cells, *centre, radius) == truth
        assert meets_block(volume.words, volume.cubes, cells, *centre, radius) or not truth
        met += truth
    assert 50 < met < 350


def test_a_ball_that_is_nowhere_counts_as_leaving_the_grid():
    grid = room(0.1)
    volume, cells = swept.volume_of(FreeSpace.from_occupied(grid, nothing_in(grid))), bits.lattice(grid)
    for place in ((np.nan, 0.0, 0.0), (0.0, np.inf, 0.0), (0.0, 0.0, -1e300)):
        assert meets_voxel(volume.words, cells, *place, 0.1)
        assert meets_block(volume.words, volume.cubes, cells, *place, 0.1)


corner = st.tuples(*(st.floats(-2, 2, width=32),) * 3)


@given(st.tuples(corner, corner, corner), corner, st.floats(0.01, 1.5))
def test_triangles_meet_the_boxes_that_cut_them(triangle, centre, half):
    found = triangle_meets_box(np.array(triangle, dtype=float), *centre, half)
    # what a rounding may decide either way is left open
    if naive.box_cuts_triangle(triangle, np.array(centre), half - 1e-6):
        assert found
    if not naive.box_cuts_triangle(triangle, np.array(centre), half + 1e-6):
        assert not found


def test_the_patches_hold_every_triangle_near_a_sample(arm):
    skin = skin_of(arm, 0.1)
    stops = np.cumsum([0] + [len(link.faces) for link in arm.links])
    for sample in range(0, len(skin.points), 7):
        link = skin.link[skin.cluster_of[sample]]
        patch = set(skin.patches[skin.patch_start[sample] : skin.patch_start[sample + 1]].tolist())
        for triangle in range(stops[link], stops[link + 1]):
            if naive.box_cuts_triangle(
                skin.triangles[triangle], skin.points[sample].astype(float), skin.cover / 2
            ):
                assert triangle in patch
        assert all(stops[link] <= triangle < stops[link + 1] for triangle in patch)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.name)
def test_no_point_moves_faster_than_its_cluster_is_said_to(arm, motion):
    start = HOME | {"slide": 0.2, "turn": 0.4, "nod": -0.3}
    way = way_of(arm, arm.positions(start), motion)
    skin = skin_of(arm, 0.1)
    placed = arm.world_from_link_array(arm.positions(start)[None])[0]
    speeds = swept.cluster_speeds(arm, skin, placed, way)
    np.testing.assert_allclose(speeds, naive.speeds_of(arm, skin, placed, way), rtol=1e-9)
    travel = np.linspace(0, way.length, 200)
    places = arm.world_from_link_array(np.array([naive.positions_at(way, t) for t in travel]))
    for sample in range(0, len(skin.points), 5):
        cluster = skin.cluster_of[sample]
        track = (
            places[:, skin.link[cluster], :3, :3] @ skin.points[sample] + places[:, skin.link[cluster], :3, 3]
        )
        steps = np.linalg.norm(np.diff(track, axis=0), axis=1)
        assert steps.max() <= speeds[cluster] * travel[1] + 1e-9


@pytest.mark.parametrize(
    "motion", [motion for motion in MOTIONS if motion.name != "nod +"], ids=lambda motion: motion.name
)
def test_halving_finds_the_same_interval_as_looking_at_every_one(arm, motion, monkeypatch):
    monkeypatch.setattr(swept, "FINEST_STEP_IN_VOXELS", 1 / 2)
    monkeypatch.setattr(swept, "SAMPLE_HALVINGS", 2)
    grid = room(0.1)
    start = arm.positions(HOME)
    skin = skin_of(arm, 0.1)
    way = way_of(arm, start, motion)
    speeds = swept.cluster_speeds(arm, skin, arm.world_from_link_array(start[None])[0], way)
    intervals = 2 ** int(np.ceil(np.log2(way.length * speeds.max() / 0.05)))
    rng = np.random.default_rng(5)
    travels = []
    for _ in range(2):
        blocked = touched_by_ball(grid, rng.uniform((-0.2, -0.6, 0.3), (1.1, 0.6, 0.8)), 0.08)
        blocked |= touched_by_box(grid, (0.95, -0.2, -0.3), (1.0, 0.3, 0.7))
        space = FreeSpace.from_occupied(grid, blocked).without(arm, HOME)
        block = swept.find_block(arm, skin, speeds, way, swept.volume_of(space))
        found = way.length if block is None else block.travel
        assert found == pytest.approx(
            naive.free_travel(arm, skin, speeds, way, space.surface, grid, intervals), abs=1e-12
        )
        travels.append(found / way.length)
    assert min(travels) < 1
