"""Who may reset and hold on: a local socket in the gate's folder that the owner alone can open. Looking goes elsewhere.

A request is a line, the answer is a line of JSON:

    status              what the gate says
    reset               forgets faults that are over; refused while one is there
    hold 123456789      a person holds on, at this time [ns of `time.monotonic_ns`]; send it anew every 50 ms
"""

import json
import os
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError

NAME = "control"
"""Of the socket, in the folder of the gate."""
MOST_BYTES = 1024
MOST_OPEN = 16
LONGEST_PATH = 100
ANSWER_S = 3.0

Answer = Callable[[str], Mapping[str, Any]]


@dataclass(slots=True, eq=False)
class Control:
    """The socket that the running monitor listens at. It waits for nobody.

    Args:
        folder: of the gate.

    Raises:
        InputError: the socket cannot be made there.
    """

    folder: Path
    _listener: socket.socket = field(init=False)
    _open: dict[socket.socket, bytes] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        path = _path_in(self.folder)
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.setblocking(False)
        mask = os.umask(0o177)
        try:
            if path.exists() and not path.is_socket():
                raise InputError(
                    f"{path}: cannot be listened at: something else lies there; take it away, or give the gate a "
                    "folder of its own"
                )
            if path.is_socket():  # of a monitor that was killed; a running one holds the folder's lock
                path.unlink()
            self._listener.bind(os.fspath(path))
        except OSError as error:
            self._listener.close()
            raise InputError(f"{path}: cannot be listened at ({error.strerror})") from None
        except InputError:
            self._listener.close()
            raise
        finally:
            os.umask(mask)
        self._listener.listen(MOST_OPEN)

    def requests(self) -> list[tuple[str, Callable[[Mapping[str, Any]], None]]]:
        """What was asked since the last call, each with what takes the answer."""
        with suppress(OSError):
            while len(self._open) < MOST_OPEN:
                asked, _ = self._listener.accept()
                asked.setblocking(False)
                self._open[asked] = b""
        found = []
        for asked in tuple(self._open):
            found += [(line, _answering(asked)) for line in self._lines(asked)]
        return found

    def _lines(self, asked: socket.socket) -> list[str]:
        """Whole lines of one who asks; one who leaves, or asks for too much, is let go."""
        try:
            data = asked.recv(4 * MOST_BYTES)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        *lines, rest = (self._open[asked] + data).split(b"\n")
        if not data or len(rest) > MOST_BYTES:
            del self._open[asked]
            if not lines:
                asked.close()
            return [line.decode("ascii", "replace") for line in lines]
        self._open[asked] = rest
        return [line.decode("ascii", "replace") for line in lines]

    def end(self) -> None:
        """Closes it."""
        for asked in self._open:
            asked.close()
        self._listener.close()
        with suppress(OSError):
            _path_in(self.folder).unlink()


def _answering(asked: socket.socket) -> Callable[[Mapping[str, Any]], None]:
    def answer(told: Mapping[str, Any]) -> None:
        with suppress(OSError):
            asked.sendall(json.dumps(dict(told)).encode() + b"\n")

    return answer


def ask(folder: Path, request: str) -> dict[str, Any]:
    """What the monitor that runs with this folder answers.

    Args:
        folder: of its gate.
        request: `status`, `reset`, or `hold` with a time.

    Raises:
        InputError: no monitor runs there, or it does not answer in time: then nothing was done that anybody knows of.
    """
    path = _path_in(folder)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as asking:
        asking.settimeout(ANSWER_S)
        try:
            asking.connect(os.fspath(path))
            asking.sendall(request.encode() + b"\n")
            with asking.makefile("rb") as file:
                line = file.readline()
        except (FileNotFoundError, ConnectionRefusedError):
            raise InputError(f"{folder}: no monitor runs with this gate") from None
        except OSError as error:
            raise InputError(f"{folder}: the monitor does not answer ({error.strerror or error})") from None
    if not line:
        raise InputError(f"{folder}: the monitor does not answer")
    answer: dict[str, Any] = json.loads(line)
    return answer


def hold(folder: Path) -> dict[str, Any]:
    """Says that a person holds on, now; to be said again every 50 ms by whoever reads the switch.

    Args:
        folder: of the gate of the running monitor.

    Raises:
        InputError: as `ask`.
    """
    return ask(folder, f"hold {time.monotonic_ns()}")


def _path_in(folder: Path) -> Path:
    """Where the socket of a folder is.

    Raises:
        InputError: longer than a socket's path may be.
    """
    path = folder / NAME
    if len(os.fsencode(path)) > LONGEST_PATH:
        raise InputError(f"{folder}: at most {LONGEST_PATH - len(NAME) - 1} characters for a gate's folder")
    return path
