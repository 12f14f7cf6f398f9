"""The watchdog as a process: whoever dies or falls silent, its readers by other hands read stop."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pymodbus.framer.rtu import FramerRTU
from pyModbusTCP.client import ModbusClient

from elbowroom.errors import InputError
from elbowroom.guard.heartbeat import PHASES, Heartbeat, Word
from elbowroom.guard.link import WatchdogLink
from elbowroom.guard.output import found
from elbowroom.guard.reason import Reason
from elbowroom.guard.registers import LAYOUT, crc16

MOTIONS = ("larm +", "larm -")
DEADLINE_NS = 150_000_000
GO = Word(640, 1, Reason.SURFACE)
COUNT = 14


def until(is_so: Callable[[], bool], seconds: float = 5.0) -> None:
    """Waits until something is so; fails if it does not come."""
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


class Wired:
    """A watchdog with a Modbus output, the monitor's end of it, and a client by other hands."""

    def __init__(self, callback: str | None = None, modbus: bool = True) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        told = {
            "motions": MOTIONS,
            "deadline_ns": DEADLINE_NS,
            "callback": callback,
            "modbus": ["127.0.0.1", self.port] if modbus else None,
        }
        self.link = WatchdogLink(told)
        self.client = ModbusClient("127.0.0.1", self.port, timeout=2.0)
        self.sequence = 0

    def beat(self, word: Word = GO, phase: str = "guarding") -> None:
        self.sequence += 1
        self.link.send(
            Heartbeat(
                self.sequence,
                time.monotonic_ns(),
                DEADLINE_NS,
                PHASES.index(phase),
                word,
                (word,) * len(MOTIONS),
                0,
                self.link.trips,
            )
        )

    def read(self) -> list[int]:
        words = self.client.read_holding_registers(0, COUNT)
        assert words is not None, self.client.last_error_as_txt
        assert words[0] == LAYOUT and words[8] == len(MOTIONS)
        assert words[-1] == crc16(words[:-1])
        return [int(word) for word in words]

    def speed(self) -> int:
        return self.read()[6]

    def goes(self) -> None:
        """Beats until the reader reads that the machine may move."""

        def is_going() -> bool:
            self.beat()
            self.link.faults()
            return self.speed() == GO.per_mille

        until(is_going)

    def end(self) -> None:
        self.client.close()
        self.beat(Word.stop(Reason.ENDED), "ended")
        self.link.end()


@pytest.fixture(scope="module")
def shared() -> Iterator[Wired]:
    wired = Wired()
    wired.link.begin()
    assert wired.link.faults() == []
    yield wired
    wired.end()


@pytest.fixture
def own() -> Iterator[Wired]:
    wired = Wired()
    wired.link.begin()
    yield wired
    wired.end()


def test_reader_reads_the_decision_and_stop_once_it_is_old(shared: Wired) -> None:
    shared.goes()
    words = shared.read()
    assert words[1] << 16 | words[2] == shared.sequence
    assert PHASES[words[4]] == "guarding" and words[5] == 1 and words[7] == Reason.SURFACE
    assert words[9:13] == [640, 1 | Reason.SURFACE << 8] * 2
    assert shared.client.read_input_registers(0, COUNT)[4:9] == words[4:9]
    until(lambda: shared.speed() == 0, 2.0)
    words = shared.read()
    assert PHASES[words[4]] == "silent" and words[7] == Reason.SILENCE
    assert words[3] >= 2 * DEADLINE_NS // 1_000_000


def test_a_stall_is_reported_and_stop_holds_until_the_monitor_knows(shared: Wired) -> None:
    shared.goes()
    until(lambda: shared.speed() == 0)
    trips = shared.link.trips  # not heard of the last one yet
    shared.sequence += 1
    late = Heartbeat(shared.sequence, time.monotonic_ns(), DEADLINE_NS, 2, GO, (GO, GO), 0, trips)
    shared.link.send(late)
    until(lambda: shared.read()[2] == shared.sequence & 0xFFFF)
    assert shared.speed() == 0
    faults = shared.link.faults()
    assert [(fault.reason, fault.subject) for fault in faults] == [(Reason.SILENCE, "watchdog")]
    assert shared.link.trips == trips + 1
    shared.goes()


def test_checksum_is_what_others_compute(shared: Wired) -> None:
    words = shared.read()
    data = b"".join(word.to_bytes(2, "big") for word in words[:-1])
    assert words[-1] == int.from_bytes(
        FramerRTU.compute_CRC(data).to_bytes(2, "little")
    )  # as it goes over the wire


WRITES = {
    "one register": lambda client: client.write_single_register(6, 1000),
    "registers": lambda client: client.write_multiple_registers(4, [2, 3, 1000]),
    "one coil": lambda client: client.write_single_coil(0, True),
    "coils": lambda client: client.write_multiple_coils(0, [True] * 8),
    "write and read": lambda client: client.write_read_multiple_registers(5, [3, 1000], 0, COUNT),
    "mask": lambda client: client.custom_request(b"\x16\x00\x06\x00\x00\x03\xe8"),
    "coils read": lambda client: client.read_coils(0, 8),
    "inputs read": lambda client: client.read_discrete_inputs(0, 8),
}


@pytest.mark.parametrize("asked", WRITES)
def test_all_but_reading_registers_is_refused(shared: Wired, asked: str) -> None:
    until(lambda: shared.speed() == 0)
    before = shared.read()
    assert not WRITES[asked](shared.client)
    assert shared.client.last_except == 1, shared.client.last_except_as_txt
    after = shared.read()
    assert [*before[:3], *before[4:13]] == [*after[:3], *after[4:13]]


def test_registers_beyond_the_last_are_refused(shared: Wired) -> None:
    assert shared.client.read_holding_registers(0, COUNT + 1) is None
    assert shared.client.last_except == 2


def test_garbage_from_the_network_ends_nothing(shared: Wired) -> None:
    noise = bytes(range(256))
    for size in (1, 7, 8, 260):
        for start in (0, 5, 60):
            with socket.create_connection(("127.0.0.1", shared.port)) as peer:
                peer.sendall((noise[start:] + noise)[:size])
    with socket.create_connection(("127.0.0.1", shared.port)) as peer:
        # diagnostics: listen only from now on; restart communications
        peer.sendall(b"\x00\x01\x00\x00\x00\x06\x01\x08\x00\x04\x00\x00")
        peer.sendall(b"\x00\x02\x00\x00\x00\x06\x01\x08\x00\x01\xff\x00")
    shared.goes()


@pytest.mark.skipif(
    shutil.which("mbpoll") is None, reason="mbpoll (Debian: apt install mbpoll) is not installed"
)
def test_mbpoll_reads_the_same(shared: Wired) -> None:
    shared.goes()
    words = ["mbpoll", "-m", "tcp", "-p", str(shared.port), "-a", "1", "-0", "-r", "0", "-c", str(COUNT)]
    told = subprocess.run([*words, "-1", "-q", "127.0.0.1"], capture_output=True, text=True, timeout=10)
    read = {
        int(line.split("]")[0][1:]): int(line.split("\t")[1].split()[0])
        for line in told.stdout.splitlines()
        if line.startswith("[")
    }
    values = [read[number] for number in range(COUNT)]
    assert values[0] == LAYOUT and values[8] == 2
    assert values[-1] == crc16(values[:-1])
    write = subprocess.run(
        ["mbpoll", "-m", "tcp", "-p", str(shared.port), "-a", "1", "-0", "-r", "6", "127.0.0.1", "1000"],
        capture_output=True,
        text=True,
        timeout=10,
    )
    assert "Illegal function" in write.stdout + write.stderr


def test_watchdog_that_is_killed_is_a_fault_and_is_started_again(own: Wired) -> None:
    own.goes()
    pid = own.link.process_id
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    until(lambda: own.client.read_holding_registers(0, COUNT) is None)
    until(lambda: [fault.reason for fault in own.link.faults()] == [Reason.WATCHDOG])
    own.beat()  # nobody reads it, and nothing is raised
    until(lambda: own.link.faults() == [], 8.0)
    assert own.link.process_id != pid
    own.goes()


def test_watchdog_that_hangs_is_a_fault(own: Wired) -> None:
    own.goes()
    assert own.link.process_id is not None
    os.kill(own.link.process_id, signal.SIGSTOP)

    def is_noticed() -> bool:
        own.beat()
        return "the watchdog does not answer" in [fault.text for fault in own.link.faults()]

    until(is_noticed)
    os.kill(own.link.process_id, signal.SIGCONT)


def test_ctrl_c_of_the_terminal_is_not_for_the_watchdog(own: Wired) -> None:
    assert own.link.process_id is not None
    os.kill(own.link.process_id, signal.SIGINT)
    own.goes()
    assert os.getpgid(own.link.process_id) != os.getpgid(0)


def test_end_that_was_asked_for_says_so_and_closes(own: Wired) -> None:
    own.goes()
    own.beat(Word.stop(Reason.ENDED), "ended")
    until(lambda: PHASES[own.read()[4]] == "ended")
    assert own.speed() == 0 and own.link.faults() == []
    begun_s = time.monotonic()
    own.link.end()
    assert time.monotonic() - begun_s < 0.9
    assert own.client.read_holding_registers(0, COUNT) is None


def test_port_that_is_taken_is_a_fault_in_one_line() -> None:
    wired = Wired()
    with socket.create_server(("127.0.0.1", wired.port)):
        wired.link.begin()
        (fault,) = wired.link.faults()
        assert fault.reason is Reason.WATCHDOG
        assert f"127.0.0.1:{wired.port} cannot be listened at" in fault.text and "\n" not in fault.text
    until(lambda: wired.link.faults() == [], 8.0)
    wired.goes()
    wired.end()


def test_callback_is_called_in_the_watchdog_also_after_the_monitor_is_gone(tmp_path: Path) -> None:
    told = tmp_path / "told.txt"
    module = tmp_path / "my_plc.py"
    module.write_text(
        "def say(said, motions):\n"
        f"    with open({str(told)!r}, 'a') as file:\n"
        "        print(said.machine.per_mille, *motions, file=file)\n"
        "    if said.machine.per_mille == 13:\n"
        "        raise RuntimeError('cable')\n"
    )
    wired = Wired(f"{module}:say", modbus=False)
    wired.link.begin()
    wired.beat()
    until(lambda: told.exists() and "640 larm + larm -" in told.read_text())
    wired.beat(Word(13, 1, 1))
    until(lambda: any("cable" in fault.text for fault in wired.link.faults()))
    assert [fault.reason for fault in wired.link.faults()] == [Reason.OUTPUT]
    wired.beat()
    until(lambda: all(fault.reason is not Reason.OUTPUT for fault in wired.link.faults()))
    wired.link.end()
    assert told.read_text().splitlines()[-1] == "0 larm + larm -"


@pytest.mark.parametrize("where", ["nowhere:say", "json:nothing", "json:__name__", "json"])
def test_callback_that_is_not_there_is_said(where: str) -> None:
    with pytest.raises(InputError, match=where):
        found(where)


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="no /proc here")
def test_running_watchdog_is_small(shared: Wired) -> None:
    maps = Path(f"/proc/{shared.link.process_id}/maps").read_text()
    assert "python" in maps and not any(name in maps for name in ("numpy", "llvmlite", "scipy"))


def test_watchdog_needs_no_numpy() -> None:
    code = (
        "import sys; import elbowroom.guard.watchdog, elbowroom.guard.modbus, pymodbus.server, pymodbus.simulator; "
        "print([name for name in sys.modules if name.split('.')[0] in ('numpy', 'numba', 'scipy', 'trimesh')])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
