"""The receiver: polls the Modbus server as a PLC does, takes silence for stop, and notes when it stopped."""

import logging
import threading
import time
from dataclasses import dataclass
from typing import Any

from elbowroom.extras import package
from elbowroom.guard.heartbeat import PHASES
from elbowroom.guard.reason import Reason
from elbowroom.guard.registers import HEAD, LAYOUT, crc16

MS = 1_000_000
EVERY_S = 0.004
SILENT_S = 0.08
"""Without a right answer for so long it is stop."""
ANSWER_S = 0.05


@dataclass(frozen=True, slots=True)
class Read:
    """What was read last.

    Args:
        finished_ns: when the last pass was finished [ns of `time.monotonic_ns`], to 1 ms.
        per_mille: the machine's speed; 0 where nothing right was answered.
        phase: of the gate; "none": nothing right was answered.
        reason: its name; "none" likewise.
    """

    finished_ns: int
    per_mille: int = 0
    phase: str = "none"
    reason: str = "none"

    @property
    def goes(self) -> bool:
        """Whether the machine may move."""
        return self.per_mille > 0 and self.phase == "guarding"


class Receiver:
    """Polls until it is closed.

    Args:
        port: of the server on this computer.
        motions: how many there are.

    Raises:
        PackageError: pymodbus is not installed.
    """

    def __init__(self, port: int, motions: int) -> None:
        self._made, self._port, self._count = (
            package("pymodbus.client").ModbusTcpClient,
            port,
            HEAD + 2 * motions + 1,
        )
        self.last = self.went = Read(time.monotonic_ns())
        """What was read last, and last while the machine might move."""
        self.stopped_ns: int | None = None
        """Since when the machine stands [ns of `time.monotonic_ns`]; None: it may move, or never did."""
        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # silence is no news here
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._poll, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends polling."""
        self._ends.set()
        self._thread.join()

    def _poll(self) -> None:
        client: Any = None
        answered_s = 0.0
        while not self._ends.wait(EVERY_S):
            at_ns = time.monotonic_ns()
            client = client or self._made("127.0.0.1", port=self._port, timeout=ANSWER_S, retries=0)
            read = self._read(client, at_ns)
            if read is not None:
                answered_s = time.monotonic()
            elif time.monotonic() - answered_s < SILENT_S:
                continue
            else:
                client.close()
                client, read = None, Read(at_ns)
            if self.last.goes and not read.goes:
                self.stopped_ns = time.monotonic_ns()
            elif read.goes:
                self.stopped_ns, self.went = None, read
            self.last = read

    def _read(self, client: Any, at_ns: int) -> Read | None:
        """What is answered; None: nothing right is."""
        try:
            if not client.connected and not client.connect():
                return None
            answer = client.read_holding_registers(0, count=self._count)
            words = [] if answer.isError() else list(answer.registers)
        except Exception:  # whatever the client raises is silence
            return None
        if len(words) != self._count or words[0] != LAYOUT or crc16(words[:-1]) != words[-1]:
            return None
        return Read(at_ns - words[3] * MS, words[6], PHASES[words[4]], Reason(words[7]).name.lower())
