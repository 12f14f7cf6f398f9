"""`elbowroom evaluate bits`: the same sums for the same work, other sums for other bits, and rows named that differ."""

import json
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.cli.evaluate import bits_run
from elbowroom.evaluate.bits.cases import ROOM, absent, cases
from elbowroom.evaluate.bits.room import Shot, simulated_rows
from elbowroom.evaluate.bits.sums import Case, differences, space_row, sum_of
from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct import DETAILS, RULES, FreeSpace
from elbowroom.simulate import InterventionRoom

TINY = Shot(2.0, voxel_size_m=0.1, size="thesis", noise="tof")


def tiny_rows():
    room = InterventionRoom()
    return list(simulated_rows(room.at(TINY.time_s), room.machine, TINY))


@pytest.fixture(scope="module")
def rows():
    return [*Case("tiny", tiny_rows).rows()]


def test_the_same_work_has_the_same_sums(rows):
    assert rows == [*Case("tiny", tiny_rows).rows()]
    judged = [(row["rule"], row["detail"]) for row in rows if row["what"] == "verdicts"]
    assert judged == [(rule, detail) for detail in DETAILS for rule in RULES]
    assert {row["what"] for row in rows} == {"truth", "frames", "explained", "space", "verdicts"}
    assert all((row["free_pct"] is not None) == (row["what"] == "space") for row in rows)


@pytest.mark.parametrize("plane", ["free", "surface", "blind", "disputed", "body"])
def test_one_bit_of_any_plane_changes_the_sum(plane):
    grid = VoxelGrid((0.0, 0.0, 0.0), (5, 4, 3), 0.1)
    space = FreeSpace.from_occupied(grid, np.zeros(grid.shape, dtype=np.bool_))
    words = getattr(space, f"{plane}_words").copy()
    words[0] ^= np.uint64(1)
    other = replace(space, **{f"{plane}_words": words})
    assert space_row(space, "three", "pixel") != space_row(other, "three", "pixel")
    assert space_row(space, "three", "pixel") == space_row(replace(space), "three", "pixel")


def test_sums_tell_names_shapes_and_types_apart():
    plain = np.arange(6, dtype=np.float32)
    others = [plain.reshape(2, 3), plain.astype(np.float64), np.flip(plain), "0 1 2 3 4 5"]
    assert len({sum_of([("a", piece)]) for piece in (plain, *others)} | {sum_of([("b", plain)])}) == 6
    assert sum_of([("a", plain[::2])]) == sum_of([("a", plain[::2].copy())])


def test_differences_name_the_row(rows):
    assert differences(rows, rows) == []
    spoilt = [dict(row) for row in rows]
    spoilt[-2] |= {"sha256": "0" * 64, "free_pct": 12.5}
    (words,) = differences(rows, spoilt)
    assert words.startswith("tiny, any, point, space: differs, free") and "12.500000 %" in words
    assert differences(rows, rows[1:]) == ["tiny, truth: not in the kept file"]
    assert differences(rows[1:], rows) == ["tiny, truth: in the kept file only"]
    assert differences([], rows, ["tiny"]) == []


def test_cases_have_names_of_their_own_and_a_few_are_quick(tmp_path):
    names = [case.name for case in cases(None, None)]
    assert len(set(names)) == len(names) > len(ROOM)
    assert 5 <= sum(case.quick for case in cases(None, None)) < len(names) / 2
    (tmp_path / "sevenscenes").mkdir()
    (tmp_path / "sevenscenes.yaml").touch()
    assert "sevenscenes" not in absent(tmp_path, tmp_path)
    assert [case.name for case in cases(tmp_path, tmp_path)] == [*names, "sevenscenes"]
    assert len(absent(tmp_path, None)) == len(absent(None, tmp_path)) == 4


@pytest.fixture
def only_tiny(monkeypatch):
    """The command on one tiny case and one that is not quick; gives a way to change what the tiny one finds."""
    found = [Case("tiny", tiny_rows, quick=True), Case("slow", tiny_rows)]
    # the command sets it by --data; so it is put back
    monkeypatch.setenv("ELBOWROOM_DATA", "nowhere")
    monkeypatch.setattr(bits_run, "cases", lambda examples, data: found)

    def change(work):
        found[0] = Case("tiny", work, quick=True)

    return change


def test_against_a_kept_file(only_tiny, tmp_path, capsys, rows):
    kept = tmp_path / "kept.json"
    here = [str(tmp_path), "--data", str(tmp_path)]
    assert run(["evaluate", "bits", *here, "--json", str(kept)]) == 0
    assert len(json.loads(kept.read_text())["rows"]) == 2 * len(rows)
    capsys.readouterr()
    assert run(["evaluate", "bits", *here, "--quick", "--against", str(kept)]) == 0
    text = capsys.readouterr().out
    assert f"{len(rows)} of {len(rows)} the same" in text and f"{len(rows)} more of it" in text
    assert "Left out" in text and "sevenscenes" in text

    def spoilt():
        first, *rest = tiny_rows()
        return [{**first, "sha256": "0" * 64}, *rest]

    only_tiny(spoilt)
    assert run(["evaluate", "bits", *here, "--against", str(kept)]) == 1
    text = capsys.readouterr().out
    assert "tiny, truth: differs\n" in text
    assert f"{2 * len(rows) - 1} of {2 * len(rows)} the same" in text and "another processor" not in text
    said = json.loads(kept.read_text())
    kept.write_text(json.dumps({**said, "meta": {**said["meta"], "processor": "one of 1979"}}))
    assert run(["evaluate", "bits", *here, "--against", str(kept)]) == 1
    assert "of another processor (one of 1979" in capsys.readouterr().out


@pytest.mark.parametrize("content", [None, "{}", "[1]", '{"rows": [{"case": "a"}]}'])
def test_a_file_to_compare_with_that_is_none_is_named(tmp_path, capsys, content):
    other = tmp_path / "other.json"
    if content is not None:
        other.write_text(content)
    assert run(["evaluate", "bits", "--against", str(other)]) == 2
    assert "other.json is no file that elbowroom evaluate bits" in capsys.readouterr().err
