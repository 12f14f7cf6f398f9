"""The files that `--json` writes: what was run on what, and rows."""

import json
import math
import os
import platform
import shlex
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError, UnfinishedWarning

AddRow = Callable[[Mapping[str, Any]], None]
END = "\n]}\n"


@contextmanager
def json_rows(path: Path | None) -> Iterator[AddRow]:
    """Gives a function that adds a row to the file; the file is there, whole, once the block has ended well.

    Rows go to disk as they come, so a long run needs no more memory than a short one. What Ctrl-C or an error ends
    keeps its rows aside, `run.part.json` for `run.json`, with the word `unfinished` in its meta, and a warning says so.

    Args:
        path: of the file; None: rows are dropped.

    Raises:
        InputError: its folder does not exist or cannot be written to; said at once, not after the work.

    Warns:
        UnfinishedWarning: Ctrl-C or an error ended it; names the file with the rows until then.
    """
    if path is None:
        yield lambda row: None
        return
    from elbowroom.files.atomic import whole_file

    with whole_file(path) as unfinished, unfinished.open("w", encoding="utf-8") as file:
        head, rows = meta(), 0
        file.write(_beginning(head))

        def add(row: Mapping[str, Any]) -> None:
            nonlocal rows
            comma = "," if rows else ""
            file.write(f"{comma}\n{json.dumps(_plain(row), allow_nan=False, separators=(',', ':'))}")
            rows += 1

        try:
            yield add
        except (KeyboardInterrupt, Exception) as ended:
            kept = None
            if rows:
                with suppress(
                    OSError, InputError
                ):  # a disk that is full: what ended it is to be said, not this
                    file.write(END)
                    file.flush()
                    kept = _keep_part(path, unfinished, head)
            if kept is not None:
                how = "interrupted" if isinstance(ended, KeyboardInterrupt) else "ended by an error"
                warnings.warn(f"{how}; the {rows} rows until then are in {kept}", UnfinishedWarning, 3)
            raise
        file.write(END)


def _beginning(head: Mapping[str, Any]) -> str:
    return '{"meta": ' + json.dumps(head) + ',\n"rows": ['


def _keep_part(path: Path, unfinished: Path, head: Mapping[str, Any]) -> Path:
    """Puts the rows of an interrupted run beside the place of the file; gives where."""
    from elbowroom.files.atomic import whole_file

    kept = path.with_suffix(f".part{path.suffix}")
    with (
        whole_file(kept) as part,
        part.open("w", encoding="utf-8") as file,
        unfinished.open(encoding="utf-8") as rows,
    ):
        rows.seek(len(_beginning(head)))
        file.write(_beginning({**head, "unfinished": True}))
        shutil.copyfileobj(rows, file)
    return kept


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
