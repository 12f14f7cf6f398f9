"""The service's process: passes come in as lines of JSON on its standard input; it ends with them.

    python -m elbowroom.service.process CONFIG

CONFIG is JSON: `host`, `port`, `token_file`, `gate` (the folder), `deadline_ns`, `origins`, `version`. On its standard
output it says, a line of JSON each, `ready` or `trouble`.
"""

import asyncio
import json
import signal
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.guard.control import ask
from elbowroom.guard.priority import step_back
from elbowroom.service.door import Door, Now, Refusal
from elbowroom.service.metrics import KIND, Metrics
from elbowroom.service.openapi import openapi
from elbowroom.service.server import Answer, Asked, Server
from elbowroom.service.token import read_token

NICE = 15
"""It gives way to whatever judges."""
MOST_LINE = 1 << 20
GETS = ("/health/live", "/health/ready", "/metrics", "/v1/status", "/openapi.json")
POSTS = ("/v1/reset", "/v1/hold")
PREFLIGHT = "OPTIONS"
"""A browser asks so whether a page may ask (Fetch standard, CORS preflight)."""
MAY_ASK = (
    ("access-control-allow-methods", "GET, POST"),
    ("access-control-allow-headers", "authorization, content-type"),
    ("access-control-max-age", "600"),
)
"""What an allowed page may ask, for so long [s]."""


class Service:
    """Answers requests.

    Args:
        told: the configuration.

    Raises:
        InputError: the token cannot be read.
        PackageError: h11 is not installed.
    """

    def __init__(self, told: Mapping[str, Any]) -> None:
        self._told, self.metrics = told, Metrics()
        port = told["port"]
        hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost", "[::1]")}
        origins = {f"http://{host}" for host in hosts} | set(told["origins"])
        self._door = Door(
            read_token(Path(told["token_file"])), frozenset(hosts), frozenset(origins), _now().wall_ms
        )
        self._gate, self._silence_s = Path(told["gate"]), 2 * told["deadline_ns"] / 1e9
        self.server = Server(self._admit, self._handle, self.metrics.answered, self._door.shares_with)

    def _admit(self, asked: Asked) -> None:
        is_preflight = asked.method == PREFLIGHT
        self._door.let_in(asked.path, asked.headers, _now(), is_preflight=is_preflight)

    async def _handle(self, asked: Asked) -> Answer:
        if asked.path not in (*GETS, *POSTS):
            raise Refusal(404, "no such path; see /openapi.json")
        if asked.method == PREFLIGHT and self._door.shares_with(asked.headers) is not None:
            return Answer(200, {"ok": True}, headers=MAY_ASK)
        if asked.method != ("POST" if asked.path in POSTS else "GET"):
            raise Refusal(405, f"{asked.path} is not asked so")
        if asked.path in POSTS:
            return await self._controlled(asked)
        return self._read(asked.path)

    def _read(self, path: str) -> Answer:
        """What needs no token; none of it reaches the monitor."""
        if path == "/health/live":
            return Answer(200, {"ok": True})
        if path == "/health/ready":
            why = self._unready()
            return Answer(200, {"ok": True}) if why is None else Answer(503, {"ok": False, "why": why})
        if path == "/metrics":
            return Answer(200, self.metrics.text(_now().steady_s), KIND)
        if path == "/openapi.json":
            return Answer(200, openapi(self._told["version"]))
        newest = self.metrics.newest
        if newest is None:
            raise Refusal(503, "no pass has been finished yet")
        return Answer(200, newest["gate"])

    def _unready(self) -> str | None:
        at_s = self.metrics.newest_s
        if at_s is None:
            return "no pass has been finished yet"
        since_s = _now().steady_s - at_s
        return None if since_s <= self._silence_s else f"no pass was finished for {since_s:.1f} s"

    async def _controlled(self, asked: Asked) -> Answer:
        """A reset, or a held signal, by the controls of the gate's folder."""
        now = _now()
        sent_ms = self._door.admitted(asked.headers, asked.body, now)
        # a signal that was on its way for a while counts from when it was sent
        sent_ns = time.monotonic_ns() - max(now.wall_ms - sent_ms, 0) * 1_000_000
        request = "reset" if asked.path == "/v1/reset" else f"hold {sent_ns}"
        try:
            said = await asyncio.to_thread(ask, self._gate, request)
        except (ElbowroomError, OSError, ValueError):
            raise Refusal(503, "the gate does not answer; nothing was done that anybody knows of") from None
        if request == "reset":
            answer = {"done": said.pop("reset"), "answer": said.pop("answer")}
            return Answer(200, {**answer, "gate": said})
        return Answer(200, {"done": bool(said["held"])})


def _now() -> Now:
    return Now(time.monotonic(), time.time_ns() // 1_000_000)


async def _run(told: Mapping[str, Any]) -> None:
    """Serves while passes come.

    Raises:
        ElbowroomError, OSError: it cannot begin.
    """
    service = Service(told)
    listening = await service.server.serve(told["host"], told["port"])
    _say({"ready": listening.sockets[0].getsockname()[1]})
    lines = asyncio.StreamReader(limit=MOST_LINE)
    loop = asyncio.get_running_loop()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin.buffer)
    while line := await lines.readline():
        service.metrics.heard(json.loads(line), _now().steady_s)
    listening.close()


def _say(told: Mapping[str, Any]) -> None:
    print(json.dumps(dict(told)), flush=True)


def main() -> int:
    """Runs the service; 1: it could not begin, and a line says why."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the monitor, with which this ends
    step_back(NICE)
    try:
        asyncio.run(_run(json.loads(sys.argv[1])))
    except (OSError, ElbowroomError) as error:
        _say({"trouble": str(error)})
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
