"""The files that `--json` writes: what was run on what, and rows."""

import json
import math
import os
import platform
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path
from typing import Any

AddRow = Callable[[Mapping[str, Any]], None]


@contextmanager
def json_rows(path: Path | None) -> Iterator[AddRow]:
    """Gives a function that adds a row to the file; the file is there, whole, once the block has ended well.

    Rows go to disk as they come, so a long run needs no more memory than a short one.

    Args:
        path: of the file; None: rows are dropped.

    Raises:
        InputError: its folder does not exist or cannot be written to; said at once, not after the work.
    """
    if path is None:
        yield lambda row: None
        return
    from elbowroom.files.atomic import whole_file

    with whole_file(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        file.write('{"meta": ' + json.dumps(meta()) + ',\n"rows": [')
        separator = "\n"

        def add(row: Mapping[str, Any]) -> None:
            nonlocal separator
            file.write(separator + json.dumps(_plain(row), allow_nan=False, separators=(",", ":")))
            separator = ",\n"

        yield add
        file.write("\n]}\n")


def write_json(path: Path | None, rows: list[dict[str, Any]]) -> None:
    """Writes all rows at once; None: nothing is written.

    Raises:
        InputError: the folder does not exist or cannot be written to.
    """
    with json_rows(path) as add:
        for row in rows:
            add(row)


def meta() -> dict[str, Any]:
    """What was run, from which source, on what."""
    return {
        "command": shlex.join(["elbowroom", *sys.argv[1:]]),
        "commit": commit(),
        "processor": f"{processor()}, {_cores()} cores",
        "versions": {
            "elbowroom": package_version(),
            "python": platform.python_version(),
            **_versions("numpy", "numba", "trimesh", "embreex"),
        },
    }


def _versions(*names: str) -> dict[str, str]:
    """Of those of these packages that are installed."""
    found = {}
    for name in names:
        with suppress(metadata.PackageNotFoundError):
            found[name] = metadata.version(name)
    return found


def package_version() -> str:
    """The installed version of elbowroom."""
    return metadata.version("elbowroom")


def commit() -> str:
    """`git describe` of the checkout that this code runs from; where it is installed, its version."""
    root = Path(__file__).resolve().parents[3]
    if (root / ".git").exists():
        words = ["git", "-C", str(root), "describe", "--always", "--dirty", "--tags"]
        try:
            return subprocess.run(
                words, capture_output=True, text=True, check=True, timeout=10
            ).stdout.strip()
        except (OSError, subprocess.SubprocessError):
            pass
    return package_version()


def processor() -> str:
    """The processor's name."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _plain(value: Any) -> Any:
    """The same value in what JSON knows; numbers that are not finite become null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)
