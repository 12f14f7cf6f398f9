"""The questions of `elbowroom bench --all`: their cases, scenes and causes."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.evaluate.speed.asked_case import run_asked
from elbowroom.evaluate.speed.asked_rows import asked_rows
from elbowroom.evaluate.speed.asked_scene import save_scene, scene_of
from elbowroom.evaluate.speed.balls import WALL_M, depth_of_balls, random_balls, ring_cameras
from elbowroom.evaluate.speed.outliers import Spent, Watch, cause_of_worst
from elbowroom.evaluate.speed.questions import DUE, Asked, all_asked


def test_a_question_varies_what_it_asks_about():
    varied = {
        "headline": {"voxel_size_m", "detail"},
        "voxels": {"voxel_size_m"},
        "cameras": {"cameras"},
        "pixels": {"width", "height"},
        "what moves": {"scene"},
        "threads": {"threads"},
        "volume": {"half_m"},
        "surface": {"balls"},
    }
    cases = list(all_asked())
    assert {case.question for case in cases} == set(varied)
    for question, keys in varied.items():
        own = [case for case in cases if case.question == question]
        different = {key for key in Asked.__slots__ if len({getattr(case, key) for case in own}) > 1}
        assert different == keys
        assert len({tuple(getattr(case, key) for key in keys) for case in own}) == len(own)


def test_every_due_figure_is_of_some_case():
    rows = [{key: getattr(case, key) for key in Asked.__slots__} for case in all_asked()]
    assert all(any(due.of(row) for row in rows) for due in DUE)


def test_a_ball_before_a_camera_is_as_far_as_its_nearest_point():
    (camera,) = ring_cameras(1, 41, 31)
    away = float(np.linalg.norm(camera.centre_in_world))
    depth = depth_of_balls(camera, np.array([[0.0, 0.0, 0.0, 0.25]]))
    assert depth[15, 20] == pytest.approx(away - 0.25, abs=1e-6)
    assert depth[0, 0] == WALL_M
    # along each ray, the point that is seen lies on the ball
    points = camera.points_in_world(depth)[depth < WALL_M]
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.25, atol=1e-5)


def test_balls_lie_within_their_cube():
    balls = random_balls(50, 0.15, 0.5)
    assert (np.abs(balls[:, :3]) + balls[:, 3:] <= 0.5).all()


def spent(ms, put_aside=0, pages=0, collections=0, **stages):
    return Spent(ms, put_aside, pages, collections, stages)


@pytest.mark.parametrize(
    ("worst", "said"),
    [
        (spent(30, carve=25.0, motion=5.0), "carve +15 ms"),
        (spent(30, 40, carve=10.0, motion=20.0), "motion +15 ms, put aside by the system 40 times more"),
        (spent(30, 0, 9000, carve=25.0, motion=5.0), "carve +15 ms, 9000 fresh pages more"),
        (spent(30, 0, 0, 1, carve=25.0, motion=5.0), "carve +15 ms, garbage was collected"),
        (spent(30), "nothing that is counted"),
    ],
)
def test_the_cause_of_the_worst_is_what_it_has_more_of(worst, said):
    usual = [spent(15, carve=10.0, motion=5.0) if worst.stage_ms else spent(15) for _ in range(4)]
    assert cause_of_worst([*usual, worst]) == said


def test_a_watch_counts_what_happens_within_it():
    import gc

    with Watch() as watch:
        gc.collect()
        kept = np.ones(20_000_000, dtype=np.uint8)
    found = watch.spent({"carve": 1.0})
    assert found.ms > 0
    assert found.collections >= 1
    assert kept.size


SMALL = Asked("voxels", 0.25, noise=False, cameras=2, width=64, height=48, threads=1, rounds=2)
HALL = replace(SMALL, question="volume", voxel_size_m=0.1, scene="balls", part="carve", half_m=0.6, balls=1)


@pytest.mark.parametrize("asked", [SMALL, HALL, replace(SMALL, scene="every pixel changes")])
def test_a_case_is_measured(asked, tmp_path):
    save_scene(tmp_path / "scene.npz", asked)
    row = run_asked(tmp_path / "scene.npz", asked)
    assert 0 < row["median_ms"] <= row["p99_ms"] <= row["max_ms"]
    assert row["cause"]
    assert row["question"] == asked.question
    if asked.part == "carve":
        assert row["voxels"] == 12**3
        assert 0 < row["surface_voxels"] < row["voxels"]
    else:
        assert set(row["stages_ms"]) >= {"explain", "carve", "resolve", "motion"}


def test_cases_that_see_the_same_have_one_scene():
    usual = Asked("voxels")
    assert scene_of(usual) == scene_of(replace(usual, question="threads", voxel_size_m=0.01, threads=1))
    assert scene_of(usual) != scene_of(replace(usual, cameras=20))
    assert scene_of(replace(HALL, half_m=1.0)) != scene_of(HALL)


def test_each_case_is_a_process_and_one_that_fails_is_told():
    (row,) = asked_rows([HALL], others=False)
    assert row["question"] == "volume"
    assert row["median_ms"] > 0
    with pytest.raises(InputError, match="ended with 1"):
        next(asked_rows([replace(HALL, rounds=0)], others=False))
