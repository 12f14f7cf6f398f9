"""Shared by all tests. With this file here, `tests/` is importable: naive twins are `reference.<name>`."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import numba
import numpy as np
import pytest
from hypothesis import settings

from elbowroom.geometry.parallel import default_threads
from elbowroom.monitor.start.compiling import run_jobs
from elbowroom.monitor.start.kernel_jobs import JOBS

if numba.config.DISABLE_JIT:
    # as in compiled code: whole numbers wrap, and floats divide by zero, without a word
    np.seterr(all="ignore")

# how long an example takes is no law: computers are shared, and the first one may load kernels; the same examples each
# time, or a change could fail for what it did not touch. `--hypothesis-profile=search` looks for others
settings.register_profile("laws", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None)
settings.load_profile("laws")

PROJECT = Path(__file__).resolve().parents[1]
EXAMPLES = PROJECT / "examples"


def pytest_configure(config: pytest.Config) -> None:
    """Compiles on all cores before the whole suite what it would compile one test after the other."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of the workers, which are one a core already
    is_worker = hasattr(config, "workerinput")
    if is_worker or config.option.collectonly or numba.config.DISABLE_JIT or not _is_whole(config):
        return
    wanted = [job for job in JOBS if not job.is_kept]
    if wanted:
        run_jobs(wanted, default_threads(), lambda name, state: None)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """The whole suite is spread over all cores; to start processes for a few named files takes longer than they do."""
    return default_threads() if _is_whole(config) else 0


def pytest_make_parametrize_id(config: pytest.Config, val: object, argname: str) -> str | None:
    """Bytes by their number: what a library writes may hold the time, and all workers must name a test alike."""
    return f"{len(val)} bytes" if isinstance(val, bytes) and not val.isascii() else None


def _is_whole(config: pytest.Config) -> bool:
    return config.args_source is pytest.Config.ArgsSource.TESTPATHS


@pytest.fixture(scope="session", autouse=True)
def _kept_apart(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What is kept from one process to the next is kept in a folder of the tests, not in the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ELBOWROOM_CACHE", str(tmp_path_factory.mktemp("cache")))
        patch.setenv("ELBOWROOM_NO_PAGE", "1")  # a test that wants a page opens it
        yield


@pytest.fixture(scope="session")
def data_root() -> Path:
    """Where real recordings lie: ELBOWROOM_DATA, or ../shared/data from the project root; may be absent."""
    return Path(os.environ.get("ELBOWROOM_DATA", PROJECT.parent / "shared" / "data")).resolve()


@pytest.fixture(scope="session")
def data_folder(data_root: Path) -> Callable[[str], Path]:
    """data_folder("sevenscenes") is that recording's folder; where it is absent the test is skipped."""

    def folder(name: str) -> Path:
        path = data_root / name
        if not path.is_dir():
            pytest.skip(f"real data absent: no folder {path}; set ELBOWROOM_DATA to where the recordings lie")
        return path

    return folder


@pytest.fixture
def example_site(data_root: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Path]:
    """example_site("sevenscenes") is that site file in examples/; skipped where its data is absent."""

    def path(name: str) -> Path:
        if not (data_root / name).is_dir():
            pytest.skip(
                f"real data absent: no folder {data_root / name}; set ELBOWROOM_DATA to where it lies"
            )
        monkeypatch.setenv("ELBOWROOM_DATA", str(data_root))
        return EXAMPLES / f"{name}.yaml"

    return path
