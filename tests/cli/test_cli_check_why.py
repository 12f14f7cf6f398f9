"""`elbowroom check` and `site check` say by how much something is in the way, and what would change it."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli import run
from elbowroom.site import Site
from reference.table_cell import POSE, cell, far_cell, table_cell

__all__ = ["cell", "far_cell"]
PROJECT = Path(__file__).resolve().parents[2]


def check(path, joint, tmp_path, *more):
    out = tmp_path / "check.json"
    argv = ["check", str(path), "--joint", joint, "--direction", "+", "--json", str(out), *more]
    assert run(argv) == 0
    (row,) = json.loads(out.read_text())["rows"]
    return row


def test_a_surface_within_the_margin_is_told_from_one_that_is_in_the_way(far_cell, tmp_path, capsys):
    assert run(["simulate", str(far_cell), "--moments", "1", "--joints", POSE]) == 0
    row = check(far_cell, "pan", tmp_path, "--out", str(tmp_path / "seen"))
    assert row["level"] == "stop" and row["cause"] == "surface" and row["link"] in ("shoulder", "upper_arm")
    measuring = [seen for seen in row["seen"] if seen["sight"] in ("surface", "edge") and seen["least_m"]]
    assert measuring
    for seen in measuring:
        # what the field's formula says: three sigmas of 0.00378 z^2, and 10 mm
        far = seen["reach_m"][1]
        assert seen["sigma_m"] == pytest.approx(0.00378 * far**2, rel=1e-6)
        assert seen["margin_m"] == pytest.approx(3 * seen["sigma_m"] + 0.01, rel=1e-6)
        assert seen["beyond_m"] < seen["margin_m"]
    assert 0.005 < row["outside_m"] < max(seen["margin_m"] for seen in measuring)
    said = capsys.readouterr().out
    assert (
        f"mm from {row['link']}, and the margin of" in said
        and "What would change it: cameras nearer than" in said
    )
    assert "pictures, one of each camera" in said
    pictures = sorted(path.name for path in (tmp_path / "seen").iterdir())
    assert pictures == sorted(path.rpartition("/")[2] for path in row["pictures"]) and len(pictures) >= 2
    for name in pictures:
        pixels = np.asarray(Image.open(tmp_path / "seen" / name).convert("RGB"))
        assert (pixels == (220, 38, 38)).all(axis=-1).sum() > 50, "the voxel is drawn in"


def test_site_check_names_the_links_that_would_be_stopped_for_ever_before_and_with_a_recording(
    far_cell, tmp_path, capsys
):
    assert run(["site", "check", str(far_cell)]) == 0
    said = capsys.readouterr().out
    assert "no folder" in said and "by the room that the site describes: link upper_arm: a surface" in said
    assert "will be stopped as long as it is there" in said
    assert run(["simulate", str(far_cell), "--moments", "1", "--joints", POSE]) == 0
    assert run(["site", "check", str(far_cell)]) == 0
    said = capsys.readouterr().out
    assert "note      link " in said and ": a surface" in said and "within the margin of" in said
    # what the note says is stopped, is
    (named,) = set(re.findall(r"so (.+?) will be stopped", said))
    for motion in named.split(", "):
        joint, way = motion.split()
        assert check(far_cell, joint, tmp_path, "--direction", way)["level"] == "stop"


def test_site_check_is_silent_where_the_arm_may_move(cell, tmp_path, capsys, monkeypatch):
    drawn = []
    monkeypatch.setattr("elbowroom.view.draw.outline.triangles_of", lambda _, joints: drawn.append(joints))
    assert run(["site", "check", str(cell), "--out", str(tmp_path / "a.png")]) == 0
    assert run(["simulate", str(cell), "--moments", "1", "--joints", POSE]) == 0
    assert run(["site", "check", str(cell), "--out", str(tmp_path / "b.png")]) == 0
    assert "margin" not in capsys.readouterr().out
    # without a recording at zero, with one where it was
    assert drawn[0]["lift"] == 0.0 and drawn[1]["lift"] == pytest.approx(np.radians(5))


def test_what_stands_in_the_way_is_not_called_the_margin(tmp_path, capsys):
    block = {"name": "block", "lower_m": [-0.3, -0.3, 1.4], "upper_m": [0.5, 0.5, 1.5]}
    path = table_cell(tmp_path)
    room = dict(Site.load(path).entry.room.model_dump(mode="json", exclude_unset=True))
    room["furniture"] = [*room["furniture"], block]
    path = table_cell(tmp_path, room=room)
    upright = "pan=0,lift=0.5,elbow=1.2,wrist_1=0,wrist_2=0,wrist_3=0"
    assert run(["simulate", str(path), "--moments", "1", "--joints", upright]) == 0
    row = check(path, "lift", tmp_path)
    if row["cause"] == "surface":
        assert row["advice"]
    said = capsys.readouterr().out
    assert "it lies within the margin" not in said


def test_a_clear_way_has_nothing_to_explain(cell, tmp_path):
    assert run(["simulate", str(cell), "--moments", "1", "--joints", POSE]) == 0
    row = check(cell, "wrist_3", tmp_path, "--out", str(tmp_path / "seen"))
    if row["level"] == "clear":
        assert row["explanation"] == row["seen"] == row["advice"] == row["pictures"] == []


def test_a_hand_at_the_wrist_is_near_the_link_that_it_stops_whatever_is_seen_beside_it(tmp_path):
    site, out = PROJECT / "examples" / "arm_on_a_table" / "cell.yaml", tmp_path / "row.json"
    words = ["--joint", "pan", "--direction", "+", "--moment", "5", "--json", str(out)]
    assert run(["check", str(site), *words]) == 0
    (row,) = json.loads(out.read_text())["rows"]
    measuring = [seen for seen in row["seen"] if seen["sight"] == "surface"]
    assert row["cause"] == "surface" and measuring
    assert row["outside_m"] <= row["voxel_size_m"] + max(seen["margin_m"] for seen in measuring)
