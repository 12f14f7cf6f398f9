"""A page, a gate and its control service: one motion may creep while somebody holds on, the others are clear."""

import socket
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.monitor.serving import Serving
from elbowroom.motion import Cause, Creep, Level
from elbowroom.page.opened import OpenedPage
from elbowroom.service.token import made_token
from elbowroom.site import Site
from elbowroom.sources import open_room
from reference.small_room import SMALL_ROOM

PASS_S = 0.03


@dataclass
class Controlled:
    """What runs.

    Args:
        page, url: the page, and where it is.
        gate, serving, token: the gate, its service and what opens that.
    """

    page: OpenedPage
    url: str
    gate: Gate
    serving: Serving
    token: str
    failing: bool = False
    _passing: threading.Lock = field(default_factory=threading.Lock)
    held: list[tuple[float, bool]] = field(default_factory=list)
    """When each pass was decided [s of `time.monotonic`], and whether a motion crept."""
    resets: list[str] = field(default_factory=list)

    @property
    def creeps(self) -> bool:
        return bool(self.held) and self.held[-1][1]

    @contextmanager
    def standing(self) -> Iterator[None]:
        """No pass is made meanwhile."""
        with self._passing:
            yield

    def until(self, holds, waits_s: float = 10.0) -> float:
        """When it held first [s]; fails where it does not hold in time."""
        until_s = time.monotonic() + waits_s
        while not holds():
            assert time.monotonic() < until_s, "it does not hold"
            time.sleep(0.005)
        return time.monotonic()


@contextmanager
def controlled_page(language: str = "en") -> Iterator[Controlled]:
    """A page whose controls are there.

    Args:
        language: of its words.
    """
    with tempfile.TemporaryDirectory() as name:  # a socket's path has to be short
        folder = Path(name)
        (folder / "room.yaml").write_text(SMALL_ROOM)
        room = open_room(Site.load(folder / "room.yaml"))
        snapshot = next(iter(room.source))
        result = plain_cycle(room).run(snapshot)
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        gate = Gate(
            folder / "gate", "test", Rules(tuple(v.motion.name for v in result.verdicts), 250_000_000, 20.0)
        )
        gate.begin()
        with OpenedPage(room, 0, language, service=port) as page:
            page.face.begin(room)
            url, token = page.said().removeprefix("page: "), made_token(folder / "token")
            serving = Serving(gate, port, folder / "token", page.origins)
            serving.start()
            run = Controlled(page, url, gate, serving, token)
            over = threading.Event()
            thread = threading.Thread(target=_judge, args=(run, snapshot, result, over))
            thread.start()
            try:
                yield run
            finally:
                over.set()
                thread.join()
                serving.end()
                gate.end()
                page.face.end()


def _judge(run: Controlled, snapshot, result, over: threading.Event) -> None:
    clear = [
        replace(v, level=Level.CLEAR, cause=Cause.NONE, free_travel=v.motion.looked_at, escapes=False)
        for v in result.verdicts
    ]
    creep = Creep(0.01, 0.01, 0.5, Cause.NONE)
    clear[0] = replace(clear[0], level=Level.STOP, cause=Cause.UNSEEN, free_travel=0.0, creep=creep)
    sequence = 0
    while not over.wait(PASS_S):
        sequence += 1
        fault = "made to fail" if run.failing else None
        with run._passing:
            judged = replace(
                result, sequence=sequence, verdicts=tuple(clear), fault=fault, stage_ms={"carve": 5.0}
            )
            at_s = time.monotonic()
            decision = run.gate.decide(judged)
            run.held.append((at_s, any(may.held and may.speed > 0 for may in decision.motions)))
            if decision.answer is not None:
                run.resets.append(decision.answer)
            done = Pass(snapshot, judged, 0.0, decision)
            run.serving.show(done)
            run.page.face.show(done)
