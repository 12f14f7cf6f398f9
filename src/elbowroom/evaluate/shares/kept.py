"""Outcomes of tasks kept in a folder, so that a run that was cut short goes on where it was."""

import base64
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from elbowroom.evaluate.shares.task import Outcome, Task
from elbowroom.files.atomic import folder, whole_file


@dataclass(frozen=True, slots=True)
class Kept:
    """A folder with a file for each task that is done.

    Args:
        path: the folder, made when the first outcome is kept; None: nothing is kept.
        source: the state of the program, as `source_state` gives it; outcomes of another are not used.
    """

    path: Path | None
    source: str

    def load(self, task: Task) -> Outcome | None:
        """The kept outcome of a task; None: not there, not whole, or of another source or other arguments."""
        if self.path is None or not self._file(task).is_file():
            return None
        try:
            kept = json.loads(self._file(task).read_text(encoding="utf-8"))
            if kept["fingerprint"] != task.fingerprint(self.source):
                return None
            pictures = {name: base64.b64decode(text) for name, text in kept["pictures"].items()}
            return Outcome(kept["rows"], pictures)
        except (ValueError, KeyError, TypeError, AttributeError):
            return None

    def keep(self, task: Task, outcome: Outcome) -> Outcome:
        """Keeps an outcome, and gives it back as it would be loaded."""
        text = json.dumps(
            {
                "fingerprint": task.fingerprint(self.source),
                "rows": outcome.rows,
                "pictures": {name: base64.b64encode(png).decode() for name, png in outcome.pictures.items()},
            },
            allow_nan=False,
        )
        if self.path is not None:
            folder(self.path)
            with whole_file(self._file(task)) as unfinished:
                unfinished.write_text(text, encoding="utf-8")
        return Outcome(json.loads(text)["rows"], outcome.pictures)

    def _file(self, task: Task) -> Path:
        assert self.path is not None
        return self.path / f"{task.part}.{task.name}.json"


def source_state() -> str:
    """A sum over all modules and data of this package: whatever is changed in it, outcomes may change, too."""
    package = Path(__file__).resolve().parents[2]
    total = hashlib.sha256()
    for path in sorted(package.rglob("*")):
        if path.suffix in (".py", ".glb", ".stl", ".urdf", ".yaml"):
            total.update(path.relative_to(package).as_posix().encode() + path.read_bytes())
    return total.hexdigest()
