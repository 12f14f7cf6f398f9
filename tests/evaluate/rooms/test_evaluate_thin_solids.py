"""Lone solids by closed formulas, and how often what they touch is declared free."""

import json

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.evaluate.rooms.lone_solids import Rod, TurnedBox
from elbowroom.evaluate.rooms.thin_solids import GRID, cameras_around, frame_of


def solids(seed):
    rng = np.random.default_rng(seed)
    return TurnedBox.hung(rng, []), Rod(rng.uniform(-0.2, 0.2, 3), rng.normal(size=3), 0.04)


def inside(solid, points):
    """Whether points lie in a solid, slowly: by the box's own axes, or by the distance to the rod's middle line."""
    if isinstance(solid, TurnedBox):
        return (np.abs((points - solid.centre) @ solid.turn) < solid.half).all(axis=-1)
    along = np.clip((points - solid.start) @ solid.along, 0, 0.6)
    return np.linalg.norm(points - solid.start - along[..., None] * solid.along, axis=-1) < solid.radius


@pytest.mark.parametrize("seed", range(4))
def test_voxels_touched_are_those_in_which_a_point_of_the_solid_lies(seed):
    rng = np.random.default_rng(seed)
    for solid in solids(seed):
        touched = solid.touched(GRID)
        points = rng.uniform(-0.6, 0.6, (200_000, 3))
        points = points[inside(solid, points)]
        hit = np.zeros(GRID.shape, dtype=bool)
        hit[tuple(GRID.index_of(points).T)] = True
        assert not (hit & ~touched).any()
        assert touched.sum() < 2.2 * hit.sum()


@pytest.mark.parametrize("seed", range(4))
def test_rays_enter_where_the_solid_begins(seed):
    rng = np.random.default_rng(seed)
    for solid in solids(seed):
        eye = np.array([2.0, 0.3, -0.4])
        rays = rng.uniform(-0.4, 0.4, (4, 500, 3)) - eye
        depth = solid.enter(eye, rays)
        met = np.isfinite(depth)
        assert met.any() and (~met).any()
        before, after = (eye + (depth[met] + off)[:, None] * rays[met] for off in (-1e-6, 1e-6))
        assert not inside(solid, before).any() and inside(solid, after).mean() > 0.99
        steps = np.linspace(0, 2, 300)[:, None, None]
        assert not inside(solid, eye + steps * rays[~met]).any()


def test_images_show_the_solid_before_the_walls_as_their_camera_measures():
    planar, radial = cameras_around(np.random.default_rng(3), 2)
    box = TurnedBox.hung(np.random.default_rng(3), [])
    for camera in (planar, radial):
        depth = frame_of(camera, box).depth_m
        points = camera.points_in_world(depth)[depth < 4]
        away = np.abs((points - box.centre) @ box.turn) - box.half
        assert len(points) and np.abs(away.max(axis=-1)).max() < 1e-3
    assert (planar.depth_kind, radial.depth_kind) == ("planar", "radial")


def test_the_command_keeps_what_three_pixel_pitches_promise(tmp_path, capsys):
    out = tmp_path / "out.json"
    assert run(["evaluate", "thin-solids", "--scenes", "1", "--json", str(out)]) == 0
    rows = json.loads(out.read_text())["rows"]
    assert len(rows) == 36 and {row["scenes"] for row in rows} == {1}
    for row in rows:
        if row["solid"] == "rod of 3 pixel pitches" and row["detail"] == "footprint":
            assert row["false_free_voxels"] == 0
        shares = 100 * (1 - row["false_free_voxels"] / row["touched_voxels"])
        assert row["occupied_pct"] == pytest.approx(shares)
    assert "box with corners" in capsys.readouterr().out
