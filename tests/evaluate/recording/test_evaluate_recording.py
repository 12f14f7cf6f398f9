"""The experiments with recordings: they find nothing lost, and they would find it."""

from elbowroom.evaluate.due import due_of
from elbowroom.evaluate.recording import cut as cutting
from elbowroom.evaluate.recording.cut import DUE, cut, cut_summary, is_noticed
from elbowroom.evaluate.recording.rate import DUE as RATE_DUE
from elbowroom.evaluate.recording.rate import rate_rows
from elbowroom.monitor.blackbox.recording import Recording
from reference.sample_run import PASSES, sample_run


def whole(path):
    path.write_bytes(sample_run())
    with Recording(path) as recording:
        return [cutting._told(one) for one in recording.passes()], recording.ends


def test_at_each_cut_at_most_one_pass_is_lost(tmp_path):
    content = sample_run()
    passes, ends = whole(tmp_path / "whole.mcap")
    assert len(passes) == PASSES
    borders = {end + more for end in ends for more in (-1, 0, 1)}
    cuts = sorted({*range(0, len(content), len(content) // 120), *borders})
    rows = [
        {"case": "cut off", "at": at, **cut(tmp_path / "cut.mcap", content[:at], passes, ends)} for at in cuts
    ]
    summary, _ = cut_summary(rows)
    assert summary["most_lost"] == 1 and summary["not_opened"] == summary["other"] == 0
    assert all(due_of(DUE, key).met(summary) for key in ("not_opened", "most_lost", "other"))


def test_a_pass_that_is_lost_or_another_is_counted(tmp_path):
    content = sample_run()
    passes, ends = whole(tmp_path / "whole.mcap")
    row = cut(tmp_path / "cut.mcap", content[: ends[3]], passes, [1, 2, 3, 4, 5, 6, *ends[6:]])
    assert row["lost"] > 1
    row = cut(tmp_path / "cut.mcap", content, [passes[1], *passes[1:]], ends)
    assert row["other"] == 1


def test_a_changed_bit_is_noticed_and_a_whole_file_is_not_suspected(tmp_path):
    content = sample_run()
    assert not is_noticed(tmp_path / "a.mcap", content)
    for at in range(0, len(content), len(content) // 60):
        changed = bytearray(content)
        changed[at] ^= 1 << at % 8
        assert is_noticed(tmp_path / "a.mcap", bytes(changed)), at


def test_small_cameras_are_kept_up_with(tmp_path):
    rows = list(rate_rows(1.2, cameras=2, size=(64, 48), place=tmp_path))
    assert [row["case"] for row in rows] == ["whole run", "black box, a stop on the way"]
    for row in rows:
        assert row["lost"] == row["not_as_given"] == 0 and row["troubles"] == []
        assert 0 < row["core_share"] < 1
    assert rows[0]["passes_in_file"] == rows[0]["passes"] == 18
    assert 6 <= rows[1]["passes_in_file"] < 18
    assert {due.key for due in RATE_DUE} <= rows[0].keys()
