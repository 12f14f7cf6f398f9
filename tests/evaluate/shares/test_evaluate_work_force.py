"""Who does the tasks does not matter, and what is done is not done again."""

import pytest

from elbowroom.cli.evaluate import thesis_run as thesis_run
from elbowroom.errors import ElbowroomError, InputError
from elbowroom.evaluate.shares.kept import Kept
from elbowroom.evaluate.shares.task import Outcome, Settings, Task
from elbowroom.evaluate.shares.work_force import do_tasks
from elbowroom.evaluate.thesis.part import Part
from reference.evaluate_tasks import dies_once, square

TASKS = [Task("part", f"t{n}", square, {"number": n}) for n in range(5)]


def done(**options):
    return {index: (outcome.rows, outcome.pictures) for index, outcome in do_tasks(TASKS, **options)}


def test_two_processes_find_the_same_as_one():
    assert done(jobs=2) == done(jobs=1) == {n: (square(n).rows, square(n).pictures) for n in range(5)}


def test_a_dask_cluster_finds_the_same():
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        assert done(cluster=cluster.scheduler_address) == done(jobs=1)


def test_the_share_of_a_lost_worker_is_done_again(tmp_path):
    tasks = [*TASKS, Task("part", "dies", dies_once, {"number": 9, "mark": str(tmp_path / "mark")})]
    assert {n: o.rows[0]["square"] for n, o in do_tasks(tasks, jobs=2)} == {
        0: 0,
        1: 1,
        2: 4,
        3: 9,
        4: 16,
        5: 81,
    }


def test_workers_that_are_always_lost_end_the_run(tmp_path):
    tasks = [
        *TASKS[:1],
        Task("part", "dies", dies_once, {"number": 9, "mark": str(tmp_path / "no" / "mark")}),
    ]
    with pytest.raises((ElbowroomError, FileNotFoundError)):
        list(do_tasks(tasks, jobs=2))


def test_no_jobs_or_no_scheduler_is_one_line():
    with pytest.raises(InputError, match="at least 1"):
        list(do_tasks(TASKS, jobs=0))


def test_kept_outcomes_are_those_that_were_kept(tmp_path):
    kept = Kept(tmp_path / "parts", "source 1")
    assert kept.load(TASKS[3]) is None
    kept.keep(TASKS[3], square(3))
    assert kept.load(TASKS[3]) == square(3)
    assert kept.load(TASKS[2]) is None
    assert Kept(tmp_path / "parts", "source 2").load(TASKS[3]) is None
    other = Task("part", "t3", square, {"number": 4})
    assert kept.load(other) is None


def test_a_damaged_file_is_as_if_it_were_not_there(tmp_path):
    kept = Kept(tmp_path, "source")
    kept.keep(TASKS[1], square(1))
    (tmp_path / "part.t1.json").write_text('{"fingerprint": ')
    assert kept.load(TASKS[1]) is None


def test_ctrl_c_keeps_what_is_finished_and_the_next_run_goes_on(tmp_path, monkeypatch, capsys):
    part = Part("part", "Title", lambda settings: TASKS, lambda rows: [], lambda rows, pictures: [])

    def interrupted(tasks, **options):
        yield 0, tasks[0].run()
        yield 3, tasks[3].run()
        raise KeyboardInterrupt

    doing = thesis_run.do_tasks
    monkeypatch.setattr(thesis_run, "do_tasks", interrupted)
    spread = thesis_run.Spread(1, None)
    with pytest.raises(KeyboardInterrupt):
        thesis_run.run_parts((part,), Settings(), spread, tmp_path / "out", tmp_path / "rows.json")
    text = " ".join(capsys.readouterr().out.split())
    assert "Interrupted after 2 of 5" in text and "goes on from there" in text
    assert not (tmp_path / "rows.json").exists()

    left = []

    def noted(tasks, **options):
        left.extend(task.name for task in tasks)
        yield from doing(tasks, jobs=1)

    monkeypatch.setattr(thesis_run, "do_tasks", noted)
    thesis_run.run_parts((part,), Settings(), spread, tmp_path / "out", tmp_path / "rows.json")
    assert left == ["t1", "t2", "t4"]
    assert (tmp_path / "out" / "report.html").is_file() and (tmp_path / "rows.json").is_file()


def test_outcomes_hold_plain_values_only(tmp_path):
    with pytest.raises(ValueError):
        Kept(tmp_path, "source").keep(TASKS[0], Outcome([{"value": float("nan")}]))
