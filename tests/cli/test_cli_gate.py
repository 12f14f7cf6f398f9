"""`monitor --gate` and `gate`: a small room from its start through a reset, read by a PLC's client, to its end."""

import json
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from pyModbusTCP.client import ModbusClient

from elbowroom.cli import run
from elbowroom.guard.control import ask
from elbowroom.guard.heartbeat import PHASES
from elbowroom.guard.latch import NAME
from elbowroom.guard.reason import Reason
from elbowroom.guard.registers import crc16
from reference.small_room import SMALL_ROOM


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.yaml"
    path.write_text(SMALL_ROOM)
    return path


class Beside(threading.Thread):
    """Does something while the monitor runs; what fails there fails the test."""

    def __init__(self, do: Callable[[], None]) -> None:
        super().__init__()
        self.do, self.error = do, None
        self.start()

    def run(self) -> None:
        try:
            self.do()
        except BaseException as error:
            self.error = error

    def done(self) -> None:
        self.join()
        if self.error is not None:
            raise self.error


def until(is_so: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def test_monitor_with_a_gate_from_its_start_through_a_reset_to_its_end(room, tmp_path, capsys):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    gate, out = tmp_path / "gate", tmp_path / "out.json"
    room.write_text(
        SMALL_ROOM + f"gate: {{folder: gate, deadline_ms: 5000, rise_per_s: 5, modbus: {{port: {port}}}}}\n"
    )
    read: list[list[int]] = []

    def person() -> None:
        until((gate / "control").exists)
        until(lambda: ask(gate, "status")["phase"] == "cleared")
        assert run(["gate", "status", str(gate), "--json", str(tmp_path / "status.json")]) == 0
        plc = ModbusClient("127.0.0.1", port, timeout=5.0)
        assert plc.read_holding_registers(0, 18)[6] == 0
        assert run(["gate", "reset", str(gate)]) == 0
        assert run(["gate", "reset", str(gate)]) == 1  # nothing is latched any more
        until(lambda: ask(gate, "status")["phase"] == "guarding")
        until(lambda: plc.read_holding_registers(0, 18)[4] == PHASES.index("guarding"))
        read.append(plc.read_holding_registers(0, 18))
        plc.close()
        os.kill(os.getpid(), signal.SIGTERM)  # as the system asks a monitor to end

    beside = Beside(person)
    assert run(["monitor", str(room), "--seconds", "60", "--json", str(out)]) == 0
    beside.done()
    shown = capsys.readouterr().out
    assert "Gate: stop until reset, this is over" in shown and "nobody has reset it" in shown
    assert "reset: the machine stays stopped until the next whole pass" in shown
    assert "refused: nothing is latched" in shown
    (words,) = read
    assert words[8] == 4 and words[-1] == crc16(words[:-1])
    assert {word >> 8 for word in words[10:18:2]} <= set(Reason)
    rows = [row for row in json.loads(out.read_text())["rows"] if row["kind"] == "gate"]
    assert rows[0]["phase"] in ("latched", "cleared") and rows[-1]["phase"] == "guarding"
    (status,) = json.loads((tmp_path / "status.json").read_text())["rows"]
    assert status["latched"][0]["reason"] == "latch_file"
    assert sorted(path.name for path in gate.iterdir()) == ["latch", "lock"]
    assert b'"mark": "ended"' in (gate / NAME).read_bytes()


def test_gate_without_a_monitor_is_one_line(tmp_path, capsys):
    for command in ("status", "reset"):
        assert run(["gate", command, str(tmp_path)]) == 2
        assert capsys.readouterr().err == f"elbowroom: {tmp_path}: no monitor runs with this gate\n"


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ("gate: {}\n", "no folder for the latch"),
        ("gate: {deadline_ms: 0.25}\n", "looks like seconds: 250"),
        ("gate: {low_speed: 0.9}\n", "low_speed"),
        ("gate: {hold_ms: 500}\n", "hold_ms"),
        ("gate: {callback: my_plc.py:say}\n", "callback"),  # opening a site runs nobody's code
        ("gate: {modbus: {port: 70000}}\n", "port"),
        ("gate: {frobnicate: 1}\n", "frobnicate"),
    ],
)
def test_what_a_site_may_not_say_of_its_gate(room, capsys, end, words):
    room.write_text(SMALL_ROOM + end)
    assert run(["monitor", str(room), "--seconds", "0"]) == 2
    assert words in capsys.readouterr().err


def test_callback_without_a_gate_is_refused(room, capsys):
    assert run(["monitor", str(room), "--seconds", "0", "--callback", "json:dumps"]) == 2
    assert "elbowroom: --callback: there is no gate" in capsys.readouterr().err


def test_modbus_without_its_package_is_refused(room, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pymodbus", None)
    room.write_text(SMALL_ROOM + "gate: {folder: gate, modbus: {}}\n")
    assert run(["monitor", str(room), "--seconds", "0"]) != 0
    assert "the Modbus output needs pymodbus" in capsys.readouterr().err


def test_gate_of_a_room_without_motions_is_refused(room, tmp_path, capsys):
    room.write_text(SMALL_ROOM[: SMALL_ROOM.index("machine:")])
    assert run(["monitor", str(room), "--seconds", "0", "--gate", str(tmp_path / "gate")]) == 2
    assert "nothing to let through" in capsys.readouterr().err


def test_open_port_is_said(room):
    from elbowroom.site import Site
    from elbowroom.site.notes import notes_of

    room.write_text(SMALL_ROOM + "gate: {folder: gate, modbus: {host: 192.168.0.10}}\n")
    assert any("whoever reaches 192.168.0.10:5020 can read" in note for note in notes_of(Site.load(room)))
    room.write_text(SMALL_ROOM + "gate: {folder: gate, modbus: {}}\n")
    assert not any("gate:" in note for note in notes_of(Site.load(room)))
