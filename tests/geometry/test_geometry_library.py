"""Kernels that were kept are loaded without their bitcode, until another kernel takes them in."""

import os
import subprocess
import sys

import pytest

INNER = """
from numba import njit

@njit(cache=True)
def twice(number):
    return 2 * number
"""
LOOK = """
import inner
print(inner.twice(4), [found.library._bitcode is None for found in inner.twice.overloads.values()])
"""
TAKE_IN = """
from numba import njit
import inner

inner.twice(4)

@njit
def thrice_twice(number):
    return 3 * inner.twice(number)

print(thrice_twice(2), [found.library._bitcode is None for found in inner.twice.overloads.values()])
"""
OURS = "import elbowroom.geometry.kernels"


@pytest.fixture
def said(tmp_path):
    """What a new process prints that shares a cache with those before it."""
    (tmp_path / "inner.py").write_text(INNER)

    def run(*code: str) -> str:
        # compiled, and kept beside it, whatever this process was told
        told = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
        place = {**told, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
        done = subprocess.run(
            [sys.executable, "-c", "\n".join(code)], env=place, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    return run


def test_bitcode_is_parsed_once_another_kernel_takes_it_in(said):
    assert said(OURS, "import inner; print(inner.twice(4))") == "8"
    assert said(OURS, LOOK) == "8 [False]"
    assert said(OURS, TAKE_IN) == "12 [True]"


@pytest.mark.parametrize(("first", "then"), [(OURS, ""), ("", OURS)])
def test_what_is_kept_is_as_numba_keeps_it(said, first, then):
    """A process without this package loads what one with it has kept, and the other way round."""
    hits = "import inner; print(inner.twice(4), sum(inner.twice.stats.cache_hits.values()))"
    assert said(first, hits) == "8 0"
    assert said(then, hits) == "8 1"


def test_a_function_that_a_library_does_not_have_is_nowhere(said):
    assert said(OURS, "import inner; print(inner.twice(4))") == "8"
    where = (
        "import inner; inner.twice(4)",
        "[found] = inner.twice.overloads.values()",
        "wrapper = found.fndesc.llvm_cpython_wrapper_name",
        "print([found.library.get_pointer_to_function(name) != 0 for name in (wrapper, 'no_such_name')])",
    )
    assert said(OURS, *where) == "[True, False]"
