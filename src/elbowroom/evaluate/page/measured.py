"""The page of the simulated room, measured: cost to the cycle, updates, a click, attacks, the report."""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due, where
from elbowroom.extras import package
from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.page.opened import OpenedPage
from elbowroom.sensing import Snapshot
from elbowroom.site import Site
from elbowroom.sources import Room, open_room

DUE = (
    Due("first_picture_s", "≤", 8.0, where(part="picture"), "from command to the first full picture"),
    Due(
        "p99_more_pct",
        "≤",
        2.0,
        where(part="cost"),
        "p99 of the cycle, more with one stalled and four good viewers",
    ),
    Due("second_mb", "≤", 1.5, where(part="updates"), "a second and viewer"),
    Due("space_hz", "≥", 9.5, where(part="updates"), "blocked space, a second"),
    Due("joints_hz", "≥", 29.0, where(part="updates"), "joints, a second"),
    Due("sentence_ms", "≤", 200.0, where(part="click"), "click to sentence, what would change it in it"),
    Due("worst_ms", "≤", 200.0, where(part="click"), "the same, worst"),
    Due("let_in", "≤", 0, where(part="attack"), "let in"),
    Due("later_ms", "≤", 5.0, where(part="flooded"), "p99 of the cycle, later while attacked"),
    Due("size_mb", "≤", 10.0, where(part="report"), "a report of 20 s"),
)
GOOD, STALLED = 4, 1
VOXEL_M, MOMENTS, RATE_HZ = 0.02, 12, 15.0
BLOCK, BLOCKS = 20, 8
"""So many passes are made with viewers and so many without, in turns, so often."""
FED_HZ = 33.0

Tell = Callable[[str], None]


@dataclass(slots=True, eq=False)
class Bench:
    """A page that is told of passes of the simulated room.

    Args:
        room: at the voxel size that is due.
        snapshots: moments of it.
        page: that is open.
    """

    room: Room
    snapshots: Sequence[Snapshot]
    page: OpenedPage
    cycle: Any = field(init=False)
    judged: list[Pass] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self.cycle = plain_cycle(self.room)
        self.judged = [Pass(one, self.cycle.run(one), 0.0) for one in self.snapshots]

    @property
    def host(self) -> str:
        """Name and port of the page."""
        return self.page.said().removeprefix("page: http://")

    def cycles(self, count: int, is_told: bool) -> list[float]:
        """Times of passes at the rate of cameras [ms].

        Args:
            count: of passes.
            is_told: whether the page is told of them.
        """
        times = []
        for number in range(count):
            begun_s = time.perf_counter()
            snapshot = self.snapshots[number % len(self.snapshots)]
            done = Pass(snapshot, self.cycle.run(snapshot), 0.0)
            if is_told:
                self.page.face.show(done)
            times.append(1e3 * (time.perf_counter() - begun_s))
            time.sleep(max(0.0, 1 / RATE_HZ - (time.perf_counter() - begun_s)))
        return times

    def feed(self, seconds: float) -> None:
        """Tells the page of passes that were judged before, faster than it takes them.

        Args:
            seconds: for how long [s].
        """
        until_s, number = time.monotonic() + seconds, 0
        while time.monotonic() < until_s:
            self.page.face.show(self.judged[number % len(self.judged)])
            number += 1
            time.sleep(1 / FED_HZ)


def page_rows(blocks: int, tell: Tell) -> Iterator[dict[str, Any]]:
    """All figures of the page, the first picture apart.

    Args:
        blocks: as of `BLOCKS`.
        tell: told what is being done.
    """
    tell("the room")
    room = open_room(Site.simulated_room(), voxel_size_m=VOXEL_M)
    snapshots = [one for one, _ in zip(room.source, range(MOMENTS), strict=False)]
    with OpenedPage(room, 0) as page:
        page.face.begin(room)
        bench = Bench(room, snapshots, page)
        page.face.show(bench.judged[0])
        tell("updates")
        yield {"part": "updates", **updates(bench, 8.0), "voxel_size_m": VOXEL_M}
        tell("clicks")
        yield {"part": "click", **clicks(bench, 20)}
        tell("cost")
        yield {"part": "cost", **cost(bench, blocks)}
        tell("attacks")
        yield from attacks(bench, blocks)
        page.face.end()
    tell("report")
    yield {"part": "report", **report(bench)}


class _Other:
    """A module that runs as a process, and says one line when it is done."""

    def __init__(self, module: str, **said: Any) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", module], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._write(json.dumps(said))

    def _write(self, line: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def line(self) -> str:
        """The next line that it says."""
        assert self._process.stdout is not None
        return self._process.stdout.readline()

    def end(self) -> Any:
        """Ends its input, and gives what it said last."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        said = self.line()
        self._process.wait(30)
        assert self._process.stdout is not None
        self._process.stdout.close()
        return json.loads(said)


def viewers(host: str, seconds: float) -> _Other:
    """Four good viewers and a stalled one, connected."""
    other = _Other("elbowroom.evaluate.page.viewers", host=host, good=GOOD, stalled=STALLED, seconds=seconds)
    other.line()
    time.sleep(1.0)
    return other


def updates(bench: Bench, seconds: float) -> dict[str, float]:
    """What a viewer gets while passes come faster than it is told.

    Args:
        bench: of the page.
        seconds: for how long [s].
    """
    looking = viewers(bench.host, seconds + 5)
    bench.feed(seconds)
    found: dict[str, float] = looking.end()
    return found


def cost(bench: Bench, blocks: int) -> dict[str, Any]:
    """What the page costs the cycle, with all viewers; in turns with a page that is not told.

    Args:
        bench: of the page.
        blocks: of each.
    """
    looking = viewers(bench.host, 600.0)
    told, untold = [], []
    for _ in range(blocks):
        untold.append(bench.cycles(BLOCK, False))
        told.append(bench.cycles(BLOCK, True))
    looking.end()
    return {**compared(told, untold), "good": GOOD, "stalled": STALLED}


def compared(one: list[list[float]], other: list[list[float]]) -> dict[str, Any]:
    """p99 and median of two kinds of blocks of times, and by how much they differ; and how much alike blocks do.

    Args:
        one, other: blocks of times [ms].
    """
    p99 = [float(np.percentile(np.concatenate(each), 99)) for each in (one, other)]
    median = [float(np.median(np.concatenate(each))) for each in (one, other)]
    halves = (
        [float(np.percentile(np.concatenate(other[n::2]), 99)) for n in (0, 1)] if len(other) > 1 else p99
    )
    return {
        "cycles": sum(map(len, one)),
        "median_ms": median[0],
        "median_without_ms": median[1],
        "p99_ms": p99[0],
        "p99_without_ms": p99[1],
        "p99_more_pct": 100 * (p99[0] / p99[1] - 1),
        "median_more_pct": 100 * (median[0] / median[1] - 1),
        "alike_pct": 100 * abs(halves[0] / halves[1] - 1),
    }


def clicks(bench: Bench, times: int) -> dict[str, Any]:
    """From a click on a motion until all is said, while passes come.

    Args:
        bench: of the page.
        times: how often.
    """
    import threading

    connect = package("websockets.sync.client").connect

    over = threading.Event()

    def run() -> None:
        while not over.is_set():
            bench.cycles(1, True)

    thread = threading.Thread(target=run)
    thread.start()
    host, took = bench.host, []
    motions = len(bench.judged[0].result.verdicts)
    with connect(f"ws://{host}/text", origin=f"http://{host}", max_size=None) as socket:
        for number in range(times):
            begun_s = time.perf_counter()
            socket.send(json.dumps({"type": "why", "motion": number % motions}))
            while True:
                said = json.loads(socket.recv(timeout=10))
                if said["type"] == "why" and said["is_final"]:
                    break
            took.append(1e3 * (time.perf_counter() - begun_s))
            time.sleep(0.4)
    over.set()
    thread.join()
    return {"clicks": times, "sentence_ms": float(np.median(took)), "worst_ms": max(took)}


def attacks(bench: Bench, blocks: int) -> Iterator[dict[str, Any]]:
    """Who got in, and what the attacks cost the cycle.

    Args:
        bench: of the page.
        blocks: of passes, with and without.
    """
    port = int(bench.host.partition(":")[2])
    quiet = [bench.cycles(BLOCK, True) for _ in range(max(2, blocks // 2))]
    attacked, rows = [], []
    for _ in range(max(2, blocks // 2)):
        seconds = 1.5 * BLOCK / RATE_HZ
        other = _Other("elbowroom.evaluate.page.attackers", port=port, seconds=seconds)
        time.sleep(0.5)
        attacked.append(bench.cycles(BLOCK, True))
        rows = other.end()
    found = compared(attacked, quiet)
    for row in rows:
        yield {"part": "attack", **row}
    yield {"part": "flooded", **found, "later_ms": found["p99_ms"] - found["p99_without_ms"]}


def report(bench: Bench) -> dict[str, Any]:
    """A report of 20 s at the rate of cameras, the room's moments coming again and again.

    Args:
        bench: whose passes are recorded.
    """
    from elbowroom.monitor.blackbox.recorder import Recorder
    from elbowroom.monitor.blackbox.recording import Recording
    from elbowroom.monitor.blackbox.sinks import WholeRun
    from elbowroom.page.replay.again import Judge
    from elbowroom.page.report.span import Span
    from elbowroom.page.report.written import write_report
    from elbowroom.page.words import words_of

    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        recorder = Recorder([WholeRun(path)], most_bytes=2_000_000_000)
        recorder.begin(bench.room)
        count = int(20 * RATE_HZ)
        for number in range(count):
            recorder.show(bench.judged[number % MOMENTS])
            time.sleep(1 / RATE_HZ)
        recorder.end()
        with Recording(path) as recording:
            begun_s, span = time.perf_counter(), Span(0, len(recording) - 1, int(0.75 * count))
            judge = Judge(recording, recording.configuration())
            written = write_report(Path(folder) / "report.html", judge, span, words_of("en"))
    return {
        "size_mb": written.size / 1e6,
        "cycles": written.cycles,
        "drawn": written.drawn,
        "took_s": time.perf_counter() - begun_s,
    }
