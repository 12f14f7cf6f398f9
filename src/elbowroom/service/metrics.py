"""Numbers for Prometheus, in its text format."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

KIND = "text/plain; version=0.0.4; charset=utf-8"
LEVELS = ("stop", "decelerate", "inform", "clear")
BUCKETS_S = (0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.15, 0.2, 0.5, 1.0)


@dataclass(slots=True, eq=False)
class Metrics:
    """What is counted from the beginning on, and the newest pass."""

    newest: Mapping[str, Any] | None = None
    newest_s: float | None = None
    """When it was heard of [s]."""
    _passes: int = field(default=0, init=False)
    _cycle_s: float = field(default=0.0, init=False)
    _buckets: list[int] = field(default_factory=lambda: [0] * len(BUCKETS_S), init=False)
    _decisions: Counter[str] = field(default_factory=Counter, init=False)
    _causes: Counter[str] = field(default_factory=Counter, init=False)
    _answers: Counter[int] = field(default_factory=Counter, init=False)

    def heard(self, told: Mapping[str, Any], now_s: float) -> None:
        """Counts a pass.

        Args:
            told: what the monitor wrote of it.
            now_s: the time [s].
        """
        self.newest, self.newest_s = told, now_s
        cycle_s = float(told["cycle_ms"]) / 1e3
        self._passes, self._cycle_s = self._passes + 1, self._cycle_s + cycle_s
        self._buckets = [n + (cycle_s <= most) for n, most in zip(self._buckets, BUCKETS_S, strict=True)]
        self._decisions[told["gate"]["level"]] += 1
        self._causes.update(told["causes"])

    def answered(self, status: int) -> None:
        """Counts an answer by its status."""
        self._answers[status] += 1

    def text(self, now_s: float) -> str:
        """All numbers.

        Args:
            now_s: the time [s].
        """
        return "".join(f"{line}\n" for line in self._lines(now_s))

    def _lines(self, now_s: float) -> Iterator[str]:
        yield from _head("elbowroom_passes_total", "counter", "Passes that were finished.")
        yield f"elbowroom_passes_total {self._passes}"
        yield from _head("elbowroom_cycle_seconds", "histogram", "Time that a pass took.")
        for most, count in zip(BUCKETS_S, self._buckets, strict=True):
            yield f'elbowroom_cycle_seconds_bucket{{le="{most}"}} {count}'
        yield f'elbowroom_cycle_seconds_bucket{{le="+Inf"}} {self._passes}'
        yield f"elbowroom_cycle_seconds_sum {self._cycle_s!r}"
        yield f"elbowroom_cycle_seconds_count {self._passes}"
        yield from _counted("elbowroom_decisions_total", "level", self._decisions, "Decisions of the gate.")
        yield from _counted(
            "elbowroom_causes_total", "cause", self._causes, "What ended the ways of motions."
        )
        yield from _counted(
            "elbowroom_service_answers_total", "status", self._answers, "Answers of this service."
        )
        if self.newest is not None and self.newest_s is not None:
            yield from self._now(self.newest, now_s - self.newest_s)

    def _now(self, told: Mapping[str, Any], since_s: float) -> Iterator[str]:
        """What the newest pass says."""
        gate = told["gate"]
        yield from _gauge("elbowroom_pass_age_seconds", since_s, "Since the last pass was heard of.")
        for name, key, words in (
            ("elbowroom_image_age_seconds", "oldest_age_ms", "Of the oldest image when its pass began."),
            ("elbowroom_skew_seconds", "skew_ms", "Between the oldest and the newest image."),
        ):
            if told[key] is not None:
                yield from _gauge(name, told[key] / 1e3, words)
        yield from _gauge(
            "elbowroom_level", LEVELS.index(gate["level"]), "Of the machine: 0 is stop, 3 clear."
        )
        yield from _gauge("elbowroom_speed_ratio", gate["speed"], "What the machine may, of full speed.")
        yield from _head("elbowroom_motion_speed_ratio", "gauge", "What a motion may, of full speed.")
        for motion, said in gate["motions"].items():
            yield f'elbowroom_motion_speed_ratio{{motion="{_escaped(motion)}"}} {said["speed"]!r}'
        yield from _gauge(
            "elbowroom_latched", len(gate["latched"]), "Faults that wait for a reset, or are there."
        )
        sick = Counter(told["sick"])
        yield from _counted("elbowroom_sick_sources", "cause", sick, "Sources that are sick now.", "gauge")


def _head(name: str, kind: str, words: str) -> Iterator[str]:
    yield f"# HELP {name} {words}"
    yield f"# TYPE {name} {kind}"


def _gauge(name: str, value: float, words: str) -> Iterator[str]:
    yield from _head(name, "gauge", words)
    yield f"{name} {float(value)!r}"


def _counted(
    name: str, label: str, counts: Mapping[Any, int], words: str, kind: str = "counter"
) -> Iterator[str]:
    """A family with one label.

    Args:
        name, label: of it.
        counts: by the label's value.
        words: of help.
        kind: of Prometheus.
    """
    yield from _head(name, kind, words)
    for value, count in sorted(counts.items()):
        yield f'{name}{{{label}="{_escaped(str(value))}"}} {count}'


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
