import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.reconstruct import FreeSpace
from elbowroom.simulate import Moment, render, wall_cameras
from elbowroom.simulate.furniture import shell
from elbowroom.view.draw.palette import LEVEL_COLOURS
from elbowroom.view.picture.fixed import machine_layer, measured_layer
from elbowroom.view.picture.layer import linear
from elbowroom.view.picture.seen import blocked_layers, frusta, sweep_layers, voxel_faces

ARM = ceiling_c_arm()
JOINTS = ARM.nearest_to_zero()


def verdict(level: Level, free: float, direction: int = 1) -> Verdict:
    motion = Motion("larm", direction, 0.05)
    return Verdict(motion, level, free, "rad", "larm_link", (0.1, 0.2, 1.0), Cause.SURFACE)


def test_voxels_show_just_the_faces_that_border_on_others() -> None:
    grid = VoxelGrid((0.0, 0.0, 0.0), (5, 4, 3), 0.1)
    which = np.random.default_rng(3).random(grid.shape) < 0.4
    count = 0
    for x, y, z in np.argwhere(which):
        for step in [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]:
            beside = (x + step[0], y + step[1], z + step[2])
            inside = all(0 <= i < n for i, n in zip(beside, grid.shape, strict=True))
            count += not (inside and which[beside])
    triangles = voxel_faces(which, grid)
    assert len(triangles) == 2 * count
    edges = np.linalg.norm(triangles[:, 1] - triangles[:, 0], axis=1)
    assert np.allclose(edges[edges < 0.12], 0.1)


def test_only_blocked_voxels_near_the_machine_are_shown() -> None:
    grid = VoxelGrid((0.0, 0.0, 0.0), (20, 20, 10), 0.1)
    occupied = np.zeros(grid.shape, dtype=bool)
    occupied[2, 2, 2] = occupied[17, 17, 7] = True
    space = FreeSpace.from_occupied(grid, occupied)
    near = np.array([[[0.1, 0.1, 0.1], [0.15, 0.1, 0.1], [0.1, 0.15, 0.1]]])
    surface, unseen, blind = blocked_layers(space, near, 0.5)
    assert len(surface.triangles) == 12 and surface.triangles.max() < 0.4
    assert len(unseen.triangles) == len(blind.triangles) == 0
    assert len(blocked_layers(space, None, 0.0)[0].triangles) == 24


def test_a_sweep_holds_the_links_where_the_way_ends() -> None:
    layers, crosses = sweep_layers(ARM, JOINTS, [verdict(Level.DECELERATE, 0.08)])
    (swept,) = layers
    assert tuple(swept.colours[0]) == linear(LEVEL_COLOURS[Level.DECELERATE])
    end = machine_layer(ARM, {**JOINTS, "larm": JOINTS["larm"] + 0.08})
    start = machine_layer(ARM, JOINTS)
    moved = np.abs(end.triangles - start.triangles).max(axis=(1, 2)) > 1e-6
    held = {tuple(np.round(t, 6).ravel()) for t in swept.triangles}
    assert {tuple(np.round(t, 6).ravel()) for t in end.triangles[moved]} <= held
    assert crosses.segments.shape == (3, 2, 3)
    np.testing.assert_allclose(crosses.segments.mean(axis=1), [(0.1, 0.2, 1.0)] * 3)


def test_a_stop_shows_the_way_that_it_would_need() -> None:
    (stop,), _ = sweep_layers(ARM, JOINTS, [verdict(Level.STOP, 0.0)])
    (slow,), _ = sweep_layers(ARM, JOINTS, [verdict(Level.DECELERATE, 0.05)])
    np.testing.assert_array_equal(stop.triangles, slow.triangles)


def test_levels_are_layers_of_their_own() -> None:
    layers, _ = sweep_layers(ARM, JOINTS, [verdict(Level.STOP, 0.0), verdict(Level.CLEAR, 0.2, -1)])
    colours = {tuple(layer.colours[0]) for layer in layers}
    assert colours == {linear(LEVEL_COLOURS[level]) for level in (Level.STOP, Level.CLEAR)}
    assert all(layer.opacity < 1 for layer in layers)


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_measured_surfaces_lie_where_the_walls_are(kind) -> None:
    cameras = wall_cameras(2, size="vga" if kind == "planar" else "thesis")
    frames = render(cameras, Moment(0.0, shell(), {}), noise=False)
    points = measured_layer(cameras, frames).triangles.reshape(-1, 3)
    walls = np.abs(np.abs(points[:, :2]) - 2.05).min(axis=1)
    ends = np.minimum(np.abs(points[:, 2]), np.abs(points[:, 2] - 2.9))
    assert len(points) > 1000
    assert np.minimum(walls, ends).max() < 2e-3


def test_fields_of_view_reach_as_far_as_asked_but_not_beyond_the_range() -> None:
    (camera,) = wall_cameras(1)
    for reach in (0.2, 0.6):
        lines, (word,) = frusta([camera], reach)
        depth = (lines.segments.reshape(-1, 3) - camera.centre_in_world) @ camera.world_from_camera[:3, 2]
        assert depth.max() == pytest.approx(reach)
        assert word.text == camera.name
