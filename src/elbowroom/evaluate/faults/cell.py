"""A monitor that runs with its gate, in a folder of its own, beside the receiver that reads what it says."""

import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from json import dumps, loads
from pathlib import Path
from typing import Any

from elbowroom.errors import ElbowroomError, InputError
from elbowroom.evaluate.faults.receiver import Receiver
from elbowroom.evaluate.faults.scene import written_site
from elbowroom.guard.control import ask

START_S, GUARDING_S = 180.0, 20.0
SETTLES_S = 0.8
"""By then it is known how often each camera gives an image [s]."""
MOVING = ("guarding", "starting")


class Cell:
    """A folder, a monitor's process, and the receiver.

    Args:
        folder: of all files.
        deadline_ms: of the gate.
    """

    def __init__(self, folder: Path, deadline_ms: float) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.deadline_ns = round(deadline_ms * 1e6)
        self.site = written_site(folder, port, deadline_ms)
        self.gate = folder / "gate"
        self.black_box: Sequence[str] = ()
        self.receiver = Receiver(port, 2)
        self.process: subprocess.Popen[str] | None = None
        self.watchdog: int | None = None
        self.said: queue.Queue[dict[str, Any]] = queue.Queue()
        self.starts = 0
        """How often a monitor was started."""
        self.troubles: list[str] = []
        """What the monitor last said that it could not keep."""

    def start(self) -> None:
        """Starts the monitor, or another one.

        Raises:
            ElbowroomError: it does not start.
        """
        self.stop()
        self.starts += 1
        words = [sys.executable, "-m", "elbowroom.evaluate.faults.monitored", str(self.site), str(self.gate)]
        words += self.black_box
        self.process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            start_new_session=True,  # Ctrl-C is for whoever throws faults: what was measured until then is kept
        )  # fmt: skip
        self.said = queue.Queue()
        threading.Thread(target=self._listen, args=(self.process, self.said), daemon=True).start()
        ready = self.next_said("ready", START_S)
        if ready is None:
            self.stop()
            raise ElbowroomError("evaluate faults: the monitor does not start")
        self.watchdog = ready["watchdog"]
        time.sleep(SETTLES_S)

    def tell(self, **what: Any) -> None:
        """Sends a line to the monitor; one that has ended hears nothing."""
        assert self.process is not None and self.process.stdin is not None
        with suppress(OSError):
            self.process.stdin.write(dumps(what) + "\n")
            self.process.stdin.flush()

    def next_said(self, key: str, most_s: float) -> dict[str, Any] | None:
        """The next line of the monitor with a key; None: none came in time.

        Args:
            key: of the line.
            most_s: to wait [s].
        """
        until_s = time.monotonic() + most_s
        while (left_s := until_s - time.monotonic()) > 0:
            with suppress(queue.Empty):
                line = self.said.get(timeout=left_s)
                self.troubles = line.get("troubles", self.troubles)
                if key in line:
                    return line
        return None

    def status(self) -> dict[str, Any]:
        """What the gate says; nothing where it does not answer."""
        with suppress(InputError, OSError, ValueError):
            return ask(self.gate, "status")
        return {}

    def guards(self) -> bool:
        """Waits until the machine may move, resetting what is over; whether it came to that."""
        until_s = time.monotonic() + GUARDING_S
        while time.monotonic() < until_s:
            if self.receiver.last.goes:
                return True
            if self.receiver.last.phase == "cleared":
                with suppress(InputError):
                    ask(self.gate, "reset")
            time.sleep(0.02)
        return False

    def signal(self, number: signal.Signals) -> None:
        """Sends a signal to the monitor."""
        assert self.process is not None
        self.process.send_signal(number)

    def stop(self) -> None:
        """Ends the monitor, if one runs."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def end(self) -> None:
        """Ends all."""
        self.stop()
        self.receiver.close()

    @staticmethod
    def _listen(process: subprocess.Popen[str], said: "queue.Queue[dict[str, Any]]") -> None:
        assert process.stdout is not None
        with suppress(ValueError):
            for line in process.stdout:
                said.put(loads(line))
