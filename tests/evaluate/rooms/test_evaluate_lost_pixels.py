"""Lost pixels are counted on planes, by how obliquely these are seen, and nowhere else."""

import json

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli import run
from elbowroom.evaluate.rooms.lost_pixels import RECORDINGS, ROWS, counts_of

FOCAL_PX = 585.0


def wall(tangent, lost=()):
    """Planar depth of a wall about 2 m away that is turned about the vertical, some columns without a return [m]."""
    across = (np.arange(60) - 29.5) / FOCAL_PX
    depth = np.tile(2.0 / (1 + tangent * across), (8, 1))
    depth[:, list(lost)] = np.nan
    return depth


@pytest.mark.parametrize("tangent", [0.0, 1.0, 3.0])
def test_a_plane_counts_with_the_tangent_at_which_it_is_seen(tangent):
    tangents, gone = counts_of(wall(tangent), FOCAL_PX)
    assert len(tangents) == 8 * 54 and not gone.any()
    assert np.median(tangents) == pytest.approx(tangent, rel=0.05)


def test_a_lone_pixel_without_a_return_is_lost_and_an_edge_is_not():
    assert counts_of(wall(0.0, lost=[30]), FOCAL_PX)[1].sum() == 8
    behind = wall(0.0)
    behind[:, 30:] = 3.0
    behind[:, 30] = np.nan
    assert not counts_of(behind, FOCAL_PX)[1].any()


def test_the_command_has_a_row_for_each_recording_and_range(tmp_path, capsys):
    for recording in RECORDINGS:
        (tmp_path / recording).mkdir()
        for number in range(3):
            millimetres = np.nan_to_num(1000 * wall(0.0, lost=[20] if number else [])).astype(np.uint16)
            Image.fromarray(millimetres).save(tmp_path / recording / f"{number}depth.png")
    out = tmp_path / "out.json"
    argv = ["evaluate", "lost-pixels", "--data", str(tmp_path), "--json", str(out)]
    assert run([*argv, "--images", "1"]) == 0
    assert [row["lost_pct"] for row in json.loads(out.read_text())["rows"][:2]] == [0.0, None]
    assert run(argv) == 0
    rows = json.loads(out.read_text())["rows"]
    assert len(rows) == ROWS and rows[0]["pixels"] > 0 and rows[0]["lost_pct"] > 0
    assert "sevenscenes" in capsys.readouterr().out


def test_a_folder_without_recordings_is_named(tmp_path, capsys):
    assert run(["evaluate", "lost-pixels", "--data", str(tmp_path)]) == 2
    assert "sevenscenes: no depth images" in capsys.readouterr().err
