"""Every reader of input from outside, tried for a while by coverage; what comes of it, a row each."""

import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.malformed.fuzzing import DONE
from elbowroom.evaluate.malformed.targets import Target, targets
from elbowroom.evaluate.malformed.trial import FINDINGS
from elbowroom.extras import package
from elbowroom.files.atomic import folder as made_folder
from elbowroom.files.progress import Progress, silent

DUE = (
    Due("crashes", "≤", 0, words="inputs that raise anything but this package's errors, or end the process"),
    Due("hangs", "≤", 0, words="inputs that hang, or take more than 2 s twice"),
    Due("allocations", "≤", 0, words="inputs that take over twice the memory that the code says"),
)
IN_MEMORY = Path("/dev/shm")
"""Where it is there, inputs are files in memory: a disk brings each to itself as it is written over."""
KINDS = {"crash": "crashes", "slow": "hangs", "allocation": "allocations"}
TELLS_S, SLACK = 10.0, 20.0
"""It is told so often how far it is [s]; a process gets so many times its processor time, on a busy computer."""


def malformed_rows(
    minutes: float = 10.0, names: Sequence[str] = (), keep: Path | None = None, tell: Progress = silent
) -> Iterator[dict[str, Any]]:
    """A row for each reader; where the process that tries it dies, the row says so, and the next one begins.

    Args:
        minutes: of processor time, for each.
        names: of readers; none: all.
        keep: a folder for inputs that were found, made when there is one; None: they are not kept.
        tell: told how far it is.

    Raises:
        PackageError: atheris is not installed.
        InputError: `keep` is no folder and cannot be made one.
    """
    package("atheris")
    if keep is not None:
        made_folder(keep)
    for target in targets():
        if not names or target.name in names:
            with TemporaryDirectory(dir=IN_MEMORY if IN_MEMORY.is_dir() else None) as folder:
                try:
                    row = _row(target, Path(folder), 60 * minutes, tell)
                finally:
                    _kept(Path(folder), keep)
            yield row


def _row(target: Target, folder: Path, seconds: float, tell: Progress) -> dict[str, Any]:
    words = [
        sys.executable,
        "-m",
        "elbowroom.evaluate.malformed.fuzzing",
        target.name,
        str(folder),
        str(seconds),
    ]
    begun = told_s = time.monotonic()
    log = folder / "log"
    with log.open("wb") as said, subprocess.Popen(words, stdout=said, stderr=said) as process:
        try:
            while process.poll() is None:
                now_s = time.monotonic()
                if now_s - begun > SLACK * seconds + 300:
                    process.kill()
                if now_s - told_s >= TELLS_S:
                    told_s, (runs, covered) = now_s, _progress(log)
                    tell(f"{target.name}: {now_s - begun:.0f} s, {runs} inputs, {covered} branches")
                time.sleep(0.2)
        finally:
            process.kill()
    runs, covered = _progress(log)
    found = _findings(folder)
    done = json.loads((folder / DONE).read_text()) if (folder / DONE).exists() else None
    if done is None:
        found.append(_ended(folder, process.returncode, runs))
    return {
        "target": target.name,
        "cpu_s": None if done is None else done["cpu_s"],
        "inputs": runs if done is None else done["runs"],
        "branches": covered,
        "limit_mb": target.limit / 1e6,
        **{KINDS[kind]: sum(each["kind"] == kind for each in found) for kind in KINDS},
        "found": found,
    }


def _ended(folder: Path, code: int, runs: int) -> dict[str, Any]:
    """What is said of a process that ended before its time; it counts, as nobody knows of what.

    Args:
        folder: of the reader: libFuzzer has kept the input there, or the log says why there is none.
        code: with which the process ended; negative: the signal.
        runs: how many inputs were tried before.
    """
    kept = [path.name for path in folder.iterdir() if path.name.startswith(("crash-", "timeout-", "oom-"))]
    kind = "slow" if any(name.startswith("timeout-") for name in kept) else "crash"
    last = " ".join((folder / "log").read_text(errors="replace")[-300:].split())
    what = "ended" if kept else f"the experiment ended after {runs} inputs, of none that was kept,"
    return {"kind": kind, "where": "", "error": f"{what} by {code}: {last}", "input": kept}


def _findings(folder: Path) -> list[dict[str, Any]]:
    file = folder / FINDINGS
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]


def _progress(log: Path) -> tuple[int, int]:
    """How many inputs were tried, and how many branches they reached, by the last line of libFuzzer."""
    told = re.findall(rb"#(\d+)[^\n]*?cov: (\d+)", log.read_bytes())
    return (int(told[-1][0]), int(told[-1][1])) if told else (0, 0)


def _kept(folder: Path, keep: Path | None) -> None:
    ours = {"log", "words"}
    found = [
        path for path in folder.iterdir() if path.is_file() and not path.suffix and path.name not in ours
    ]
    if keep is not None and found:
        for path in found:
            shutil.copy(path, keep / path.name)
