"""The face that feeds the control service: a line after each pass, if there is room for one; nobody waits."""

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.files.json_rows import package_version
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.told import decision_row
from elbowroom.sources import Room

START_S, END_S = 15.0, 1.0
HOST = "127.0.0.1"


@dataclass(slots=True, eq=False)
class Serving:
    """The service's process, as a face of the monitor.

    Args:
        gate: that its requests reach.
        port: where it listens on this computer.
        token_file: of its token.
        origins: of pages that may ask it.
    """

    gate: Gate
    port: int
    token_file: Path
    origins: Sequence[str] = ()
    _process: subprocess.Popen[bytes] | None = field(default=None, init=False)
    _left: bytes = field(default=b"", init=False)

    def start(self) -> None:
        """Starts the service, and waits until it listens.

        Raises:
            InputError: it cannot begin: a port that is taken, a token that others can read, a package that is missing.
        """
        told = {
            "host": HOST,
            "port": self.port,
            "token_file": os.fspath(self.token_file.absolute()),
            "gate": os.fspath(self.gate.folder.absolute()),
            "deadline_ns": self.gate.rules.deadline_ns,
            "origins": list(self.origins),
            "version": package_version(),
        }
        self._process = subprocess.Popen(
            [sys.executable, "-m", "elbowroom.service.process", json.dumps(told)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            start_new_session=True,
        )
        said = self._first_line()
        if "ready" not in said:
            self._kill()
            raise InputError(f"service: {said.get('trouble', 'it does not begin')}")
        assert self._process.stdin is not None
        os.set_blocking(self._process.stdin.fileno(), False)

    def _first_line(self) -> Mapping[str, Any]:
        assert self._process is not None and self._process.stdout is not None
        until_s, line = time.monotonic() + START_S, b""
        while not line.endswith(b"\n") and (left_s := until_s - time.monotonic()) > 0:
            if select.select([self._process.stdout], [], [], left_s)[0]:
                read = os.read(self._process.stdout.fileno(), 4096)
                if not read:
                    break
                line += read
        with suppress(ValueError):
            found: Mapping[str, Any] = json.loads(line)
            return found
        return {}

    def begin(self, room: Room) -> None:
        """It was started before."""

    def show(self, done: Pass) -> None:
        """Writes a line; one for which there is no room is left out."""
        if self._process is None or self._process.stdin is None or done.decision is None:
            return
        if not self._left:
            self._left = json.dumps(self._row(done), separators=(",", ":")).encode() + b"\n"
        try:
            sent = os.write(self._process.stdin.fileno(), self._left)
        except OSError:
            return  # full, or gone: who asks the service is told how old what it knows is
        self._left = self._left[sent:]

    def _row(self, done: Pass) -> dict[str, Any]:
        result = done.result
        assert done.decision is not None
        return {
            "sequence": result.sequence,
            "cycle_ms": result.cycle_ms,
            "oldest_age_ms": result.oldest_age_ms,
            "skew_ms": result.skew_ms,
            "causes": [verdict.cause.name.lower() for verdict in result.verdicts],
            "sick": [each.cause.name.lower() for each in result.sick],
            "gate": {**decision_row(done.decision), "site": self.gate.site},
        }

    def end(self) -> None:
        """Lets the service end."""
        if self._process is None:
            return
        if self._process.stdin is not None:
            with suppress(OSError):
                self._process.stdin.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(END_S)
        self._kill()

    def _kill(self) -> None:
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._process = None
