"""A gate in a process of its own, its watchdog and a Modbus reader by other hands: suspended, killed, started again."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pyModbusTCP.client import ModbusClient

from elbowroom.guard.control import ask
from elbowroom.guard.heartbeat import PHASES
from elbowroom.guard.latch import Mark, write_latch
from elbowroom.guard.reason import Reason
from elbowroom.guard.registers import crc16

SITE = "cell"
DEADLINE_NS = 400_000_000
COUNT = 14
MONITOR = """
import sys, time
from pathlib import Path
from elbowroom.guard.link import WatchdogLink
from elbowroom.monitor import CycleResult
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.motion import Cause, Level, Motion, Verdict

folder, site, deadline_ns, port = sys.argv[1:]
motions = Motion("slide", +1, 0.1), Motion("slide", -1, 0.1)
rules = Rules(tuple(motion.name for motion in motions), int(deadline_ns), rise_per_s=5.0)
told = {"motions": rules.motions, "deadline_ns": int(deadline_ns), "callback": None, "modbus": ["127.0.0.1", int(port)]}
gate = Gate(Path(folder), site, rules, WatchdogLink(told))
gate.begin()
verdicts = tuple(Verdict(motion, Level.CLEAR, 0.6, "m", None, None, Cause.NONE) for motion in motions)
sequence = 0
while True:
    sequence += 1
    gate.decide(CycleResult(sequence, 0, None, verdicts, {}, None))
    time.sleep(0.02)
"""


def until(is_so: Callable[[], bool], seconds: float = 10.0) -> None:
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.005)


class Cell:
    """A folder, a port, the monitor's process and a PLC's client."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.script = folder / "monitor.py"
        self.script.write_text(MONITOR)
        self.gate = folder / "gate"
        self.gate.mkdir()
        write_latch(self.gate / "latch", SITE, Mark.ENDED)
        self.plc = ModbusClient("127.0.0.1", self.port, timeout=2.0)
        self.monitor: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        words = [str(self.script), str(self.gate), SITE, str(DEADLINE_NS), str(self.port)]
        self.monitor = subprocess.Popen([sys.executable, *words])

    def read(self) -> list[int] | None:
        words = self.plc.read_holding_registers(0, COUNT)
        if words is None:
            return None
        assert words[-1] == crc16(words[:-1])
        return [int(word) for word in words]

    def says(self, phase: str, reason: Reason | None = None, per_mille: int = 0) -> bool:
        words = self.read()
        if words is None or words[4] != PHASES.index(phase) or words[6] != per_mille:
            return False
        return reason is None or words[7] == reason

    def signal(self, number: signal.Signals) -> None:
        assert self.monitor is not None
        os.kill(self.monitor.pid, number)

    def end(self) -> None:
        self.plc.close()
        if self.monitor is not None:
            self.monitor.kill()
            self.monitor.wait()


@pytest.fixture
def cell(tmp_path: Path) -> Iterator[Cell]:
    cell = Cell(tmp_path)
    yield cell
    cell.end()


def test_suspended_killed_and_started_again_the_machine_stays_stopped_until_a_reset(cell: Cell) -> None:
    cell.start()
    until(lambda: cell.says("guarding", Reason.NONE, 1000), 30.0)

    # suspended: the watchdog says stop; resumed, the gate has latched it
    cell.signal(signal.SIGSTOP)
    suspended_s = time.monotonic()
    until(lambda: cell.says("silent", Reason.SILENCE), 3.0)
    assert time.monotonic() - suspended_s < 2 * DEADLINE_NS / 1e9 + 1.0
    cell.signal(signal.SIGCONT)
    until(lambda: cell.says("cleared", Reason.RESET_DUE))
    time.sleep(0.3)
    assert cell.says("cleared", Reason.RESET_DUE)
    assert ask(cell.gate, "reset")["reset"]
    until(lambda: cell.says("guarding", Reason.NONE, 1000))

    # killed: the watchdog says stop, then it is gone too; started again, it is no reset
    cell.signal(signal.SIGKILL)
    until(lambda: cell.says("silent", Reason.SILENCE), 3.0)
    assert cell.monitor is not None
    cell.monitor.wait()
    cell.start()
    until(lambda: cell.says("cleared", Reason.RESET_DUE), 30.0)
    latched = {fault["reason"] for fault in ask(cell.gate, "status")["latched"]}
    assert "unclean_end" in latched
    assert ask(cell.gate, "reset")["reset"]
    until(lambda: cell.says("guarding", Reason.NONE, 1000))
