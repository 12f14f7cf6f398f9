"""A process of the page begun early: it imports what it needs while the run that it will show is still being opened."""

import atexit
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Self

PAGE = "elbowroom.page.process"
LOG = "page.log"


@dataclass(frozen=True, slots=True, eq=False)
class Early:
    """A process that waits to be told what to show; it ends where this one does before.

    Args:
        process: with standard input and output as text.
        folder: for what it is told; gone with this process at the latest.
    """

    process: Any
    folder: Path

    @classmethod
    def begun(cls, program: str = PAGE) -> Self:
        """One that begins now.

        Args:
            program: the module that runs in it.
        """
        folder = Path(tempfile.mkdtemp(prefix="elbowroom-page-"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        with (folder / LOG).open("w") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", program],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
            )
        return cls(process, folder)

    def end(self) -> None:
        """Ends it, where nobody has told it what to show, or whoever did has not let it go."""
        if self.process.stdin.closed:
            return
        self.process.terminate()
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        shutil.rmtree(self.folder, ignore_errors=True)


@contextmanager
def early_page() -> Iterator[Early | None]:
    """The page's process, begun, and ended where it was not used; None: its packages are missing."""
    if find_spec("viser") is None:
        yield None
        return
    early = Early.begun()
    try:
        yield early
    finally:
        early.end()
