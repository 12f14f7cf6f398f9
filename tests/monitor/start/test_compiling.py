"""Kernels are compiled in jobs, in processes of their own; together they are all that a run calls."""

import sys
from importlib import import_module

import pytest

from elbowroom.monitor.start.compiling import run_jobs
from elbowroom.monitor.start.kernel_jobs import JOBS, Job
from elbowroom.monitor.start.start import started
from elbowroom.site import Site
from elbowroom.sources import open_room

ECHO = (sys.executable, "-c", "import sys\nfor line in sys.stdin: print(line.strip(), flush=True)")
DIES = (sys.executable, "-c", "input()")


def job(name: str, after: str | None = None) -> Job:
    return Job(name, lambda: None, ("elbowroom.geometry.kernels.bits", "bit_of"), after=after)


def told_of(jobs, workers, command):
    told: list[tuple[str, str]] = []
    run_jobs(jobs, workers, lambda name, state: told.append((name, state)), command)
    return told


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_every_job_is_done_once_and_after_what_it_needs(workers):
    told = told_of([job("c", after="a"), job("a"), job("b")], workers, ECHO)
    assert sorted(told) == sorted((name, state) for name in "abc" for state in ("begun", "done"))
    assert told.index(("a", "done")) < told.index(("c", "begun"))


def test_a_process_that_dies_fails_its_jobs_and_ends_the_run():
    told = told_of([job("a"), job("b", after="a")], 1, DIES)
    assert ("a", "failed") in told and ("b", "failed") in told


def test_jobs_come_after_jobs_that_exist_and_are_begun_before():
    names = [job.name for job in JOBS]
    for n, each in enumerate(JOBS):
        assert each.after is None or each.after in names[:n]


def test_a_run_compiles_nothing_that_the_jobs_did_not():
    for each in JOBS:
        each.run()
        module, kernel = each.last  # by which the next start knows that the job is done
        assert getattr(import_module(module), kernel).signatures, each.name
    before = _compiled()
    # so fine that parts of voxels are asked as well
    room = open_room(Site.simulated_room(), cameras=3, resolution=(320, 240))
    started(room, lambda step: None).run([], seconds=0.0)
    more = {kernel for kernel, many in _compiled().items() if many > before.get(kernel, 0)}
    assert not more and before["ask_parts"]


def _compiled() -> dict[str, int]:
    """For how many kinds of arguments each kernel is compiled, of those that Python calls by themselves."""
    kernels = [kernel for name in list(sys.modules) if ".kernels." in name for kernel in _kernels_of(name)]
    return {kernel.py_func.__name__: len(kernel.signatures) for kernel in kernels}


def _kernels_of(name: str):
    if not name.startswith("elbowroom."):
        return []
    return [thing for thing in vars(import_module(name)).values() if hasattr(thing, "signatures")]
