"""What a run of the monitor came to: rates, times, levels, faults."""

import time
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from elbowroom.files.peak_memory import peak_memory_mb
from elbowroom.monitor import CycleResult
from elbowroom.monitor.rows import shares_pct
from elbowroom.motion import Level
from elbowroom.view.screen.words import LEVEL_WORDS, NOT_CERTIFIED

RECENT = 15
"""So many passes are looked at for figures that are shown live."""
MOST_SICK = 12
"""So many sick sources are named in the summary, those first that were so for longest."""
KEPT = 100_000
"""So many passes are looked at for the summary: the latest ones, some two hours at 12 Hz."""


@dataclass(slots=True, eq=False)
class RunLog:
    """Times and levels of the passes of a run. Frame age: of the oldest frame, when the verdicts are out.

    Args:
        source: what brings the frames, such as "simulator".
        unchecked_links: links of the machine that are not checked; every summary names them.
        bodiless_links: links that move without a body; every summary names them too.
        allowances: what else the site lets pass, a line each.
    """

    source: str = "source"
    unchecked_links: Sequence[str] = ()
    bodiless_links: Sequence[str] = ()
    allowances: Sequence[str] = ()
    cycle_ms: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT), init=False)
    source_ms: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT), init=False)
    age_ms: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT), init=False)
    skew_ms: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT), init=False)
    stages: deque[dict[str, float]] = field(default_factory=lambda: deque(maxlen=RECENT), init=False)
    ends_s: deque[float] = field(default_factory=lambda: deque(maxlen=RECENT + 1), init=False)
    free_pct: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT), init=False)
    levels: dict[str, Counter[Level]] = field(default_factory=dict, init=False)
    faults: Counter[str] = field(default_factory=Counter, init=False)
    late: int = field(default=0, init=False)
    sick: Counter[tuple[str, str]] = field(default_factory=Counter, init=False)
    stops: dict[str, str] = field(default_factory=dict, init=False)
    is_watched: bool = field(default=False, init=False)
    cycles: int = field(default=0, init=False)
    start_s: float = field(default_factory=time.perf_counter, init=False)

    def add(self, result: CycleResult, source_ms: float) -> None:
        """Notes one pass, just ended.

        Args:
            result: of the pass.
            source_ms: what the simulator or the reader of files took to bring its frames [ms].
        """
        self.cycles += 1
        self.cycle_ms.append(result.cycle_ms)
        self.source_ms.append(source_ms)
        if result.age_ms is not None:
            self.age_ms.append(result.age_ms)
        if result.skew_ms is not None:
            self.skew_ms.append(result.skew_ms)
        self.stages.append(dict(result.stage_ms))
        self.ends_s.append(time.perf_counter())
        for verdict in result.verdicts:
            self.levels.setdefault(verdict.motion.name, Counter())[verdict.level] += 1
        if not result.verdicts and result.space is not None:
            self.free_pct.append(shares_pct(result.space)["free_pct"])
        if result.fault is not None:
            self.faults[result.fault] += 1
        if result.late is not None:
            self.late += 1
        for sick in result.sick:
            self.sick[sick.source, sick.cause.word] += 1
        if result.health is not None:
            self.is_watched = True
            self.stops = dict(result.health.stops)

    @property
    def rate_hz(self) -> float:
        """Passes per second of late; 0 before there were two."""
        if len(self.ends_s) < 2:
            return 0.0
        return (len(self.ends_s) - 1) / max(self.ends_s[-1] - self.ends_s[0], 1e-9)

    @property
    def whole_rate_hz(self) -> float:
        """Passes per second of the whole run."""
        if self.cycles == 0:
            return 0.0
        return self.cycles / max(self.ends_s[-1] - self.start_s, 1e-9)

    @property
    def recent_stage_ms(self) -> dict[str, float]:
        """Median time of each stage of late [ms], in the order of the stages."""
        names = dict.fromkeys(name for stages in self.stages for name in stages)
        return {name: float(np.median([s[name] for s in self.stages if name in s])) for name in names}

    def row(self) -> dict[str, Any]:
        """The run as the row of kind "summary", after all others; with the most memory that this process has taken."""
        row: dict[str, Any] = {
            "kind": "summary",
            "cycles": self.cycles,
            "rate_hz": self.whole_rate_hz,
            "faults": self.faults.total(),
            "late": self.late,
            "watched": self.is_watched,
            "stop_reasons": list(self.stops.values()),
        }
        for name, values in (("cycle", self.cycle_ms), ("source", self.source_ms)):
            for statistic, share in (("median", 50), ("p99", 99), ("max", 100)):
                row[f"{name}_{statistic}_ms"] = float(np.percentile(values, share)) if values else None
        row["peak_rss_mb"] = peak_memory_mb()
        return row

    def recent(self, values: Sequence[float]) -> float:
        """Median of the latest of some values; NaN if there are none."""
        latest = list(values)[-RECENT:]
        return float(np.median(latest)) if latest else float("nan")

    def summary(self) -> RenderableType:
        """What is printed at the end."""
        seconds = max(self.ends_s[-1] - self.start_s, 0.0) if self.ends_s else 0.0
        head = Text(f"{self.cycles} cycles in {seconds:.1f} s, {self.whole_rate_hz:.1f} Hz", style="bold")
        if self.cycles == 0:
            return Group(head, Text("no verdict was given"))
        lines: list[RenderableType] = [
            head,
            self._times(),
            Text(),
            self._shares(),
            Text(),
            *self._said_at_the_end(),
        ]
        return Group(*lines, Text(NOT_CERTIFIED, "dim"))

    def _times(self) -> Table:
        times = Table("", "median", "99 %", "worst", box=None, pad_edge=False, header_style="dim")
        rows = (
            ("cycle", self.cycle_ms),
            ("frame age", self.age_ms),
            ("skew", self.skew_ms if any(self.skew_ms) else ()),
            (self.source, self.source_ms),
        )
        for name, values in rows:
            if values:
                p50, p99, worst = np.percentile(values, (50, 99, 100))
                times.add_row(name, f"{p50:.1f} ms", f"{p99:.1f} ms", f"{worst:.1f} ms")
        return times

    def _shares(self) -> RenderableType:
        """How often each motion was at each level; where none is asked, what was free."""
        if self.free_pct:
            low, mid, high = np.percentile(self.free_pct, (0, 50, 100))
            return Text(
                f"free: {mid:.1f} % of the watched box, {low:.1f} to {high:.1f} %; no motion was judged"
            )
        shares = Table("movement", *LEVEL_WORDS.values(), box=None, pad_edge=False, header_style="dim")
        for name, counts in self.levels.items():
            total = counts.total()
            shares.add_row(
                name, *(f"{counts[level] / total:.0%}" if counts[level] else "-" for level in Level)
            )
        return shares

    def _said_at_the_end(self) -> Iterator[Text]:
        """What failed, what was stopped, and what was not looked after."""
        if self.faults:
            fault, times_seen = self.faults.most_common(1)[0]
            count = self.faults.total()
            yield Text(f"{count} cycles failed and said stop; most often ({times_seen}): {fault}", "bold red")
        if self.late:
            late = f"{self.late} of {self.cycles} cycles said stop"
            text = f"{late}, as images were past max_frame_age_ms when their verdicts were out"
            yield Text(f"{text}: larger voxels, fewer pixels or more cores make a pass shorter", "bold red")
        for (source, word), count in self.sick.most_common(MOST_SICK):
            of = f"{count} of {self.cycles} cycles"
            yield Text(f"{source}: {word.replace('_', ' ')} in {of}", "bold")
        for reason in self.stops.values():
            yield Text(f"Every motion was stopped: {reason}", "bold red")
        if self.stops:
            yield Text(
                "Look at it; commission again if it stays where it is. Starting again clears the stop."
            )
        if not self.is_watched:
            yield Text("Cameras were not watched: one that is knocked would not have been noticed.", "dim")
        elif not self.stops:
            yield Text("No camera moved, and the machine was where its joints said.")
        if self.unchecked_links:
            yield Text(f"Not checked, by the site's word: {', '.join(self.unchecked_links)}")
        if self.bodiless_links:
            yield Text(f"Without a body, by the site's word: {', '.join(self.bodiless_links)}")
        yield from map(Text, self.allowances)
