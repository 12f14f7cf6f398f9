"""Loads published robots as a user would, and counts what came of it."""

import time
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import MachineError, MachineWarning
from elbowroom.evaluate.due import Due, Row
from elbowroom.evaluate.robots.plain_reader import Plain, plain
from elbowroom.evaluate.robots.published import Published, published
from elbowroom.machine import Machine
from elbowroom.machine.poses import drawn_between

OF_A_PART = ("has no <link>", "names link", "Undefined substitution argument")
"""What is said of xacro files that are parts of others: macros, or links that hang on links of another file."""
POSES = 5
"""Each machine is posed so often, at random within its limits."""


def _files(row: Row) -> bool:
    return row.get("kind") == "summary" and row.get("format") == "urdf"


DUE = (
    Due(
        "loads_of_machines_pct", "≥", 97.0, _files, "URDFs that describe a machine, all of it there, and load"
    ),
    Due("lost_unsaid", "≤", 0.0, _files, "machines that lose a part unsaid"),
    Due("crashes", "≤", 0.0, _files, "files that end in another error than one line with a place"),
)
"""What is due of the files of each run."""


def robot_rows(folders: Sequence[Path], leave_out: Sequence[str] = ()) -> Iterator[dict[str, Any]]:
    """A row for each URDF and xacro file below folders.

    Args:
        folders: in which packages were unpacked or installed.
        leave_out: files with one of these words in their path are none of it.

    Raises:
        InputError: as `published`.
    """
    for file in published(folders):
        if not any(word in file.name for word in leave_out):
            yield _row(file)


def _row(file: Published) -> dict[str, Any]:
    start = time.perf_counter()
    row: dict[str, Any] = {
        "kind": "robot",
        "package": file.package,
        "version": file.version,
        "file": file.name,
        "format": file.path.suffix.lower()[1:],
        "outcome": "loads",
        "text": "",
        "links": 0,
        "with_body": 0,
        "findings": 0,
        "lost": [],
    }
    second = plain(file.path, file.root) if row["format"] == "urdf" else Plain(frozenset(), "", True)
    row |= {"lacks": second.lacks, "moves": second.moves}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MachineWarning)
            machine = Machine.from_urdf(file.path)
        _pose(machine)
    except MachineError as error:
        text = _without_folders(str(error), file)
        return {**row, "outcome": "refused" if _has_place(text, file) else "crash", "text": text}
    except Exception as error:  # whatever else a published file makes fail is what is looked for
        return {
            **row,
            "outcome": "crash",
            "text": f"{type(error).__name__}: {_without_folders(str(error), file)}",
        }
    bodies = {link.name for link in machine.links if link.has_geometry}
    lost = sorted(second.with_geometry - bodies)
    told = [finding.text for finding in machine.findings]
    return {
        **row,
        "links": len(machine.links),
        "with_body": len(bodies),
        "findings": len(told),
        "lost": [name for name in lost if not any(f"link {name}:" in text for text in told)],
        "seconds": round(time.perf_counter() - start, 2),
    }


def _pose(machine: Machine) -> None:
    """Poses a machine; an error of it is an outcome."""
    random = np.random.default_rng(1)
    ends = [drawn_between(machine.joint(name)) for name in machine.joint_names]
    for _ in range(POSES):
        at = [random.uniform(lower, upper) for lower, upper in ends]
        machine.world_from_links(dict(zip(machine.joint_names, at, strict=True)))


def _without_folders(text: str, file: Published) -> str:
    """A message without the folders of the computer that wrote it."""
    for root in (str(file.root.resolve()), str(file.root)):
        text = text.replace(f"{root}/", "").replace(root, ".")
    return text


def _has_place(text: str, file: Published) -> bool:
    return "\n" not in text and file.path.name in text


def summary_rows(rows: Sequence[Row]) -> list[Row]:
    """What the rows of each format come to."""
    summaries: list[Row] = []
    for form in sorted({str(row["format"]) for row in rows}, reverse=True):
        of = [row for row in rows if row["format"] == form]
        macros = [row for row in of if form == "xacro" and any(word in row["text"] for word in OF_A_PART)]
        files = [row for row in of if row not in macros]
        whole = [row for row in files if not row["lacks"]]
        machines = [row for row in whole if row["moves"]]
        loads = [row for row in files if row["outcome"] == "loads"]
        summaries.append(
            {
                "kind": "summary",
                "format": form,
                "packages": len({row["package"] for row in files}),
                "files": len(files),
                "parts_of_others": len(macros),
                "loads": len(loads),
                "loads_pct": _share(files),
                "whole": len(whole),
                "loads_of_whole_pct": _share(whole),
                "machines": len(machines),
                "loads_of_machines_pct": _share(machines),
                "refused": sum(row["outcome"] == "refused" for row in files),
                "crashes": sum(row["outcome"] == "crash" for row in files),
                "lost_unsaid": sum(bool(row["lost"]) for row in files),
            }
        )
    return summaries


def _share(rows: Sequence[Row]) -> float:
    """How many of some files load [%]."""
    return 100 * sum(row["outcome"] == "loads" for row in rows) / max(len(rows), 1)
