"""The face on the terminal: a row for each joint and direction, and how fast and how fresh the answers are."""

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.padding import Padding
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from elbowroom.monitor import CycleResult, Decision, Pass
from elbowroom.monitor.gate.told import gate_lines
from elbowroom.monitor.health.streams.told import sick_lines
from elbowroom.monitor.rows import shares_pct
from elbowroom.monitor.separation.margins import Margins
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.sources import Room
from elbowroom.view.screen.run_log import RunLog
from elbowroom.view.screen.watched import Watched, watched_of
from elbowroom.view.screen.words import (
    LEVEL_WORDS,
    MARKS,
    NOT_CERTIFIED,
    cause_text,
    counts_text,
    health_text,
    margins_text,
    place_first,
    place_text,
    plain_line,
    shares_text,
    travel_bar,
    travel_text,
)

STYLES: dict[Level, str] = {
    Level.STOP: "bold white on red3",
    Level.DECELERATE: "bold black on orange1",
    Level.INFORM: "black on sky_blue2",
    Level.CLEAR: "green",
}
BAR_STYLES: dict[Level, str] = {
    Level.STOP: "red3",
    Level.DECELERATE: "orange1",
    Level.INFORM: "sky_blue2",
    Level.CLEAR: "green",
}
REFRESH_S = 0.125
"""The screen is drawn anew no more often than this: eyes need no more, and drawing takes milliseconds."""
PLAIN_EVERY_S = 1.0
WIDE_BAR, NARROW_BAR = 20, 5
"""Characters of the bar of free travel, on screens of 100 columns or more, and below."""


class TerminalView:
    """Shows passes as they come: a live screen on a terminal, a line a second elsewhere.

    As a context, it stops the screen at its end.

    Args:
        console: where to show it; None: standard output.
    """

    watched: Watched
    """What the run watches; there from its beginning on."""

    def __init__(self, console: Console | None = None) -> None:
        self.log = RunLog()
        self.console = console or Console()
        # a screen of its own: what the keyboard echoes there does not stay behind
        live = (
            Live(console=self.console, auto_refresh=False, screen=True) if self.console.is_terminal else None
        )
        self._live = live
        self._last_screen: RenderableType | None = None
        self._last_shown_s = float("-inf")
        self._said: dict[tuple[str, tuple[str, ...]], str] = {}
        self._decision: Decision | None = None
        self._margins: Margins | None = None

    def __enter__(self) -> "TerminalView":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def begin(self, room: Room) -> None:
        """Begins the screen, and the time that rates are counted over."""
        self.open(watched_of(room))

    def open(self, watched: Watched) -> None:
        """As `begin`, by what its head says."""
        self.watched, self.log = (
            watched,
            RunLog(watched.source, watched.unchecked_links, watched.bodiless_links, watched.allowances),
        )
        if self._live is not None:
            self._live.start()
        else:
            self.console.print(f"{self.watched.title}: {self.watched.room}", soft_wrap=True, highlight=False)

    def stop(self) -> None:
        """Ends the screen and prints what it showed last. Does nothing the second time."""
        if self._live is not None and self._live.is_started:
            self._live.stop()
            if self._last_screen is not None:
                self.console.print(self._last_screen)

    def show(self, done: Pass) -> None:
        """Notes a pass and, if it is time, shows it."""
        result, self._decision, self._margins = done.result, done.decision, done.margins
        self.log.add(result, done.source_ms)
        self._warn(result)
        now = time.perf_counter()
        if now - self._last_shown_s < (REFRESH_S if self._live is not None else PLAIN_EVERY_S):
            return
        self._last_shown_s = now
        if self._live is not None:
            self._last_screen = self.screen(result)
            self._live.update(self._last_screen, refresh=True)
        else:
            self.console.print(self.line(result), soft_wrap=True, highlight=False, markup=False)
            for line in (*sick_lines(result.sick), *self._gate(), *self._distances()):
                self.console.print(line, soft_wrap=True, highlight=False, markup=False)

    def end(self) -> None:
        """Ends the screen and prints what the run came to."""
        self.stop()
        if self._live is not None:
            for text in self._said.values():
                self._print_warning(text)
        self.console.print(self.log.summary())

    def note(self, text: str) -> None:
        """Prints a line that the user should know before it starts."""
        self.console.print(f"note: {text}", highlight=False, soft_wrap=True)

    def _warn(self, result: CycleResult) -> None:
        """Says what was found about the input, each thing once: at once in plain lines, at the end of a screen."""
        for finding in result.findings:
            of = finding.kind, finding.about
            if of not in self._said:
                self._said[of] = finding.text
                if self._live is None:
                    self._print_warning(finding.text)

    def _print_warning(self, text: str) -> None:
        self.console.print(f"warning: {text}", highlight=False, soft_wrap=True, markup=False)

    def screen(self, result: CycleResult) -> RenderableType:
        """All of the live screen for one pass."""
        wide = self.console.width >= 100
        lines: list[RenderableType] = [
            Rule(Text(f"elbowroom  ·  {self.watched.title}", "bold"), style="dim"),
            Text(self.watched.room, "dim"),
            self._speed(result),
            Text(),
            self._judged(result, wide),
            Text(),
            Text(health_text(result.health), "dim"),
            *(Text(line, "dim") for line in self._distances()),
        ]
        lines += [Text(f" {line} ", STYLES[Level.STOP]) for line in _stops(result)]
        lines += [Text(line, "bold") for line in (*sick_lines(result.sick), *self._gate())]
        lines += [Text(f"Warning: {finding.text}") for finding in result.findings if not finding.stops]
        if self.watched.unchecked_links:
            lines.append(
                Text(f"Not checked, by the site's word: {', '.join(self.watched.unchecked_links)}", "dim")
            )
        if self.watched.bodiless_links:
            lines.append(
                Text(f"Without a body, by the site's word: {', '.join(self.watched.bodiless_links)}", "dim")
            )
        lines += [Text(line, "dim") for line in self.watched.allowances]
        lines.append(Text(NOT_CERTIFIED, "dim"))
        return Padding(Group(*lines), (0, 1))

    def line(self, result: CycleResult) -> str:
        """One pass in one plain line."""
        age = "" if result.age_ms is None else f" age {result.age_ms:.0f} ms{_skew(result.skew_ms)}"
        head = (
            f"{result.stamp_ns / 1e9:8.2f} s {self.log.rate_hz:5.1f} Hz cycle {result.cycle_ms:.0f} ms{age}"
        )
        if result.fault is not None:
            return f"{head} | STOP, the cycle failed: {result.fault}"
        if result.stopped_by is not None:
            return f"{head} | STOP: {result.stopped_by}"
        if not result.verdicts and result.space is not None:
            return f"{head} | {shares_text(shares_pct(result.space))}"
        return " | ".join([head, *map(plain_line, result.verdicts)])

    def _gate(self) -> list[str]:
        """What the gate says, a line each; said again with each line or screen."""
        return [] if self._decision is None else gate_lines(self._decision)

    def _distances(self) -> list[str]:
        """How far the machine is from what it may hit, in one line, if it is known."""
        return [] if self._margins is None else [margins_text(self._margins)]

    def _speed(self, result: CycleResult) -> Text:
        log = self.log
        age = result.age_ms if result.late is not None else log.recent(log.age_ms)
        # what rounds to nothing is left out
        stages = " + ".join(f"{name} {ms:.0f}" for name, ms in log.recent_stage_ms.items() if ms >= 0.5)
        levels = [verdict.level for verdict in result.verdicts]
        text = Text()
        text.append(f"{log.rate_hz:.1f} Hz", "bold")
        text.append("  frame age ")
        style = "bold" if result.late is None else STYLES[Level.STOP]
        text.append("unknown" if result.age_ms is None else f"{age:.0f} ms", style)
        text.append(_skew(result.skew_ms))
        text.append("  cycle ")
        text.append(f"{log.recent(log.cycle_ms):.0f} ms", "bold")
        text.append(f" = {stages}", "dim")
        judged = counts_text(levels) or "no motion is judged"
        if levels:
            judged += f", safe speed {100 * result.safe_speed:.0f} %"
        text.append(f"\n{result.stamp_ns / 1e9:.1f} s, cycle {result.sequence + 1}: {judged}")
        text.append(
            f"  ({self.watched.source} apart: {log.recent(log.source_ms):.0f} ms; Ctrl-C ends)", "dim"
        )
        return text

    def _judged(self, result: CycleResult, wide: bool) -> RenderableType:
        """The verdicts; where no motion is asked, what is free."""
        if result.verdicts or result.space is None:
            return self._table(result.verdicts, wide)
        return Text(shares_text(shares_pct(result.space)), "bold")

    def _table(self, verdicts: Sequence[Verdict], wide: bool) -> Table:
        table = Table(box=None, pad_edge=False, header_style="dim", padding=(0, 2 if wide else 1, 0, 0))
        bar = WIDE_BAR if wide else NARROW_BAR
        table.add_column("movement", no_wrap=True)
        table.add_column("level", no_wrap=True, width=14)
        table.add_column("free", justify="right", no_wrap=True, width=9)
        table.add_column("   S   M           L" if wide else "SM  L", no_wrap=True, width=bar)
        table.add_column("cause", no_wrap=True)
        table.add_column("where", no_wrap=True, overflow="ellipsis", ratio=1)
        for verdict in verdicts:
            table.add_row(*self._row(verdict, wide))
        return table

    def _row(self, verdict: Verdict, wide: bool) -> list[Text]:
        level = verdict.level
        filled, rest = travel_bar(verdict, WIDE_BAR if wide else NARROW_BAR)
        whole_reach = verdict.free_travel >= _looked_at(verdict) * (1 - 1e-9)
        more = "≥ " if whole_reach else ""
        at_limit = verdict.cause is Cause.NONE and not whole_reach
        cells = [
            Text(verdict.motion.name),
            Text(f" {MARKS[level]} {LEVEL_WORDS[level]} ".ljust(14), STYLES[level]),
            Text(more + travel_text(verdict.free_travel, verdict.free_travel_unit), "bold"),
        ]
        return [
            *cells,
            Text.assemble((filled, BAR_STYLES[level]), (rest, "dim")),
            Text("joint limit" if at_limit else _why(verdict)),
            Text(place_text(verdict) if wide else place_first(verdict), "dim"),
        ]


def _why(verdict: Verdict) -> str:
    """What ends it; of one that nothing ends, whether it leads out of what the machine stands close beside."""
    return "leads away" if verdict.escapes and verdict.cause is Cause.NONE else cause_text(verdict)


def _stops(result: CycleResult) -> list[str]:
    """Why every motion is stop, a line each."""
    found = () if result.health is None else result.health.stops.values()
    lines = [f"Stop: {reason}. Stays until the monitor is started again." for reason in found]
    lines += [f"Stop: {finding.text}" for finding in result.findings if finding.stops]
    lines += [f"Stop: {text}" for text in (result.late, result.blind) if text is not None]
    if result.stopping is not None and result.stopping.first is not None:
        first = result.stopping.first
        lines.append(f"Stop: as fast as it is, it does not rest before {first.cause.value} ({first.link})")
    lines += _path(result)
    return lines if result.fault is None else [*lines, f"Stop, since the cycle failed: {result.fault}"]


def _path(result: CycleResult) -> list[str]:
    """What is in the way of the path that the machine means to take, with time and place."""
    if result.off_path is not None:
        return [f"Stop: {result.off_path}"]
    first = None if result.path is None else result.path.first
    if result.path is None or first is None:
        return []
    met = first.other_link or first.zone
    where = "" if first.place_in_world is None else " at {:.2f} {:.2f} {:.2f} m".format(*first.place_in_world)
    word = "Stop" if result.path.level is Level.STOP else "Path"
    what = f"{first.cause.value}{f', {met}' if met else ''}"
    return [f"{word}: in {max(first.time_s, 0.0):.2f} s the path meets {what} ({first.link}{where})"]


def _looked_at(verdict: Verdict) -> float:
    """How far a verdict could have said to go [m or rad along the joint]."""
    motion = verdict.motion
    return motion.looked_at if isinstance(motion, Motion) else motion.reach or float("inf")


def _skew(skew_ms: float | None) -> str:
    """How far apart the frames of a pass were, in words; nothing where that rounds to nothing."""
    return "" if skew_ms is None or skew_ms < 0.5 else f" skew {skew_ms:.0f} ms"
