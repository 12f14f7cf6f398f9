"""A monitor with its gate and its control service, in turn left alone and attacked."""

import json
import secrets
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.faults.live import Live
from elbowroom.evaluate.faults.scene import written_site
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.made import gate_of
from elbowroom.monitor.serving import Serving
from elbowroom.monitor.start.start import started
from elbowroom.service.token import made_token
from elbowroom.site import Site
from elbowroom.sources import Room, open_room

DUE = (
    Due("let_in", "≤", 0, words="requests that were let in"),
    Due("later_ms", "≤", 5, words="by which any pass is later than the latest without attacks, worst"),
    Due(
        "service_later_ms",
        "≤",
        5,
        words="than the latest while the same attacker asks a server that only closes",
    ),
)
NOBODY, CLOSING, SERVICE = AGAINST = ("nobody", "closing", "service")
"""Whom the attacker asks: nobody; a server that only closes, so that what is later is the attacker's own doing; the
control service."""
A_SECOND = 1000.0
SETTLES_S = 2.0
DEADLINE_MS = 1000.0


class Times:
    """The face that notes how long after its snapshot each pass is done [ms], and who reached the gate."""

    def __init__(self) -> None:
        self.done_ms: list[float] = []
        self.resets = 0

    def begin(self, room: Room) -> None:
        """Nothing has been judged."""

    def show(self, done: Pass) -> None:
        """Notes a pass."""
        if done.snapshot.now_ns is not None:
            self.done_ms.append((time.monotonic_ns() - done.snapshot.now_ns) / 1e6)
        if done.decision is not None and done.decision.answer is not None:
            self.resets += 1

    def end(self) -> None:
        """The run has ended."""


def service_rows(
    rounds: int = 6,
    seconds: float = 5.0,
    a_second: float = A_SECOND,
    tell: Callable[[str], None] = lambda told: None,
) -> Iterator[dict[str, Any]]:
    """A row for each stretch of time: by turns without attacks, on a server that only closes, and on the service.

    Args:
        rounds: how often each.
        seconds: how long each [s].
        a_second: requests of the attack.
        tell: what is being done.

    Raises:
        InputError: the service cannot begin.
        PackageError: h11 is not installed.
    """
    with TemporaryDirectory() as folder, socket.create_server(("127.0.0.1", 0)) as free:
        ports = free.getsockname()[1], 0
        free.close()
        yield from _rows(Path(folder), ports[0], (rounds, seconds, a_second), tell)


def _rows(
    folder: Path, port: int, asked: tuple[int, float, float], tell: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    rounds, seconds, a_second = asked
    room = open_room(Site.load(written_site(folder, None, DEADLINE_MS)))
    room = replace(room, source=Live(room.cameras))
    tell("starting the monitor")
    gate = gate_of(room, folder / "gate")
    assert gate is not None
    loop = replace(started(room, lambda told: None), gate=gate)
    token, times = made_token(folder / "token"), Times()
    serving = Serving(gate, port, folder / "token")
    serving.start()
    ends = threading.Event()
    thread = threading.Thread(target=loop.run, args=([serving, times], None, ends.is_set), daemon=True)
    thread.start()
    closing, closing_port = _closing()
    try:
        time.sleep(SETTLES_S)
        body = _let_in(port, token)
        while not times.resets:  # it is answered before its pass is shown, and counts as let in by nobody
            time.sleep(0.01)
        for number in range(rounds):
            for against in AGAINST:
                tell(f"round {number + 1} of {rounds}, the attacker asks: {against}")
                to = {NOBODY: None, CLOSING: closing_port, SERVICE: port}[against]
                how = None if to is None else partial(_attack, to, (a_second, seconds), body, token)
                yield {
                    "kind": "stretch",
                    "round": number,
                    "against": against,
                    **_stretch(times, how, seconds),
                }
    finally:
        ends.set()
        thread.join()
        closing.communicate(timeout=10)


def _closing() -> tuple[subprocess.Popen[str], int]:
    """A server that only closes, and its port."""
    words = [sys.executable, "-m", "elbowroom.evaluate.service.closing"]
    closing = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert closing.stdout is not None
    return closing, int(closing.stdout.readline())


def _let_in(port: int, token: str) -> str:
    """The body of a reset that was let in."""
    body = json.dumps({"nonce": secrets.token_hex(16), "time_ms": time.time_ns() // 1_000_000})
    headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
    request = urllib.request.Request(f"http://127.0.0.1:{port}/v1/reset", body.encode(), headers)
    with urllib.request.urlopen(request, timeout=10):
        return body


def _stretch(times: Times, attack: Callable[[], dict[str, Any]] | None, seconds: float) -> dict[str, Any]:
    """A stretch of time: how late passes were, and what came of the attack.

    Args:
        times: of passes.
        attack: does it; None: there is none.
        seconds: how long it is then [s].
    """
    times.done_ms, resets = [], times.resets
    answers: dict[str, Any] = {}
    if attack is not None:
        answers = attack()
    else:
        time.sleep(seconds)
    done = np.array(times.done_ms)
    return {
        "passes": len(done),
        "median_ms": float(np.median(done)),
        "p99_ms": float(np.percentile(done, 99)),
        "worst_ms": float(done.max()),
        "let_in": times.resets - resets + sum(said.get("200", 0) for said in answers.values()),
        "answers": answers,
    }


def _attack(port: int, how: tuple[float, float], body: str, token: str) -> dict[str, Any]:
    words = [
        sys.executable,
        "-m",
        "elbowroom.evaluate.service.attacker",
        str(port),
        *map(str, how),
        body,
        token,
    ]
    said = subprocess.run(words, capture_output=True, text=True, check=False).stdout
    found: dict[str, Any] = {}
    with suppress(ValueError):
        found = json.loads(said)
    return found


def service_summary(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each kind of attack, and one for all.

    Args:
        rows: of `service_rows`.
    """
    answers: dict[str, dict[str, int]] = {}
    for row in (row for row in rows if row["against"] == SERVICE):
        for kind, said in row["answers"].items():
            mine = answers.setdefault(kind, {})
            for status, count in said.items():
                mine[status] = mine.get(status, 0) + count
    found: list[dict[str, Any]] = [
        {
            "kind": "attack",
            "case": case,
            "requests": sum(said.values()),
            "answered": ", ".join(f"{status or 'closed'}: {count}" for status, count in sorted(said.items())),
            "let_in": said.get("200", 0),
        }
        for case, said in answers.items()
    ]
    alone, closing, attacked = ([row for row in rows if row["against"] == name] for name in AGAINST)
    if not (alone and closing and attacked):
        return found
    worst = {
        name: max(row["worst_ms"] for row in some)
        for name, some in zip(AGAINST, (alone, closing, attacked), strict=True)
    }
    total = {
        "kind": "service",
        "case": "all",
        "requests": sum(row["requests"] for row in found),
        "let_in": sum(row["let_in"] for row in rows),
        "passes": sum(row["passes"] for row in attacked),
        "alone_median_ms": float(np.median([row["median_ms"] for row in alone])),
        "attacked_median_ms": float(np.median([row["median_ms"] for row in attacked])),
        "alone_p99_ms": max(row["p99_ms"] for row in alone),
        "attacked_p99_ms": max(row["p99_ms"] for row in attacked),
        "closing_p99_ms": max(row["p99_ms"] for row in closing),
        "alone_worst_ms": worst[NOBODY],
        "closing_worst_ms": worst[CLOSING],
        "attacked_worst_ms": worst[SERVICE],
        "later_ms": max(worst[SERVICE] - worst[NOBODY], 0.0),
        "attacker_later_ms": max(worst[CLOSING] - worst[NOBODY], 0.0),
        "service_later_ms": max(worst[SERVICE] - worst[CLOSING], 0.0),
    }
    return [*found, total]
