"""The controls of a gate: its owner alone, on this computer, and nobody who asks can hold the monitor up."""

import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from elbowroom.errors import InputError
from elbowroom.guard.control import MOST_OPEN, Control, ask, hold


@pytest.fixture
def control(tmp_path: Path) -> Iterator[Control]:
    control = Control(tmp_path)
    yield control
    control.end()
    assert not (tmp_path / "control").exists()


def served(control: Control, seen: list[str], seconds: float = 3.0) -> threading.Thread:
    """Answers whatever is asked with what was asked, as a monitor would between its passes."""

    def serve() -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end and not seen:
            for request, answer in control.requests():
                seen.append(request)
                answer({"asked": request})
            time.sleep(0.005)

    thread = threading.Thread(target=serve)
    thread.start()
    return thread


def test_what_is_asked_is_answered(tmp_path: Path, control: Control) -> None:
    seen: list[str] = []
    thread = served(control, seen)
    assert ask(tmp_path, "reset") == {"asked": "reset"}
    thread.join()


def test_hold_says_when(tmp_path: Path, control: Control) -> None:
    seen: list[str] = []
    before_ns = time.monotonic_ns()
    thread = served(control, seen)
    hold(tmp_path)
    thread.join()
    word, _, when = seen[0].partition(" ")
    assert word == "hold" and before_ns <= int(when) <= time.monotonic_ns()


def test_its_owner_alone_can_open_it(tmp_path: Path, control: Control) -> None:
    assert oct((tmp_path / "control").stat().st_mode & 0o777) == "0o600"


def test_what_a_killed_monitor_left_is_taken_over(tmp_path: Path, control: Control) -> None:
    again = Control(tmp_path)  # who may do that holds the folder's lock
    seen: list[str] = []
    thread = served(again, seen)
    assert ask(tmp_path, "status") == {"asked": "status"}
    thread.join()
    again.end()


def test_garbage_and_crowds_hold_nobody_up(tmp_path: Path, control: Control) -> None:
    crowd = []
    for number in range(MOST_OPEN + 4):
        peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        peer.setblocking(False)
        try:
            peer.connect(str(tmp_path / "control"))
            peer.sendall(b"\xff" * 3000 if number % 2 else b"stat")
        except OSError:
            pass
        crowd.append(peer)
    begun_s = time.monotonic()
    for _ in range(5):
        assert control.requests() == []
    assert time.monotonic() - begun_s < 0.5
    for peer in crowd:
        peer.close()
    for _ in range(3):
        control.requests()
    seen: list[str] = []
    thread = served(control, seen)
    assert ask(tmp_path, "status") == {"asked": "status"}
    thread.join()


def test_one_who_left_before_the_answer_is_no_matter(tmp_path: Path, control: Control) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer:
        peer.connect(str(tmp_path / "control"))
        peer.sendall(b"reset\nstatus\n")
    requests = control.requests()
    assert [request for request, _ in requests] == ["reset", "status"]
    for _, answer in requests:
        answer({"a": "b" * 100_000})
    assert control.requests() == []


def test_what_is_no_socket_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "control").write_text("somebody's notes")
    with pytest.raises(InputError, match="cannot be listened at: something else lies there; take it away"):
        Control(tmp_path)
    assert (tmp_path / "control").read_text() == "somebody's notes"


def test_nobody_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no monitor runs"):
        ask(tmp_path, "reset")


def test_monitor_that_hangs_is_said(
    tmp_path: Path, control: Control, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("elbowroom.guard.control.ANSWER_S", 0.1)
    with pytest.raises(InputError, match="does not answer"):
        ask(tmp_path, "reset")


def test_folder_with_too_long_a_name_is_said(tmp_path: Path) -> None:
    deep = tmp_path / ("d" * 90)
    deep.mkdir()
    with pytest.raises(InputError, match="characters"):
        Control(deep)
