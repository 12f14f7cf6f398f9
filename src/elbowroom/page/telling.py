"""Moments as browsers are told of them: the same for a run, a recording and a report."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.why.changes import Change
from elbowroom.page.story.cameras import Rates, camera_rows
from elbowroom.page.story.gate import gate_said
from elbowroom.page.story.headline import headline
from elbowroom.page.story.motions import looked_at_of, motion_rows, with_reach
from elbowroom.page.story.path import path_said
from elbowroom.page.story.told import Told
from elbowroom.page.story.why_text import why_text
from elbowroom.page.words import Words


@dataclass(slots=True, eq=False)
class Telling:
    """Puts moments of a run into words.

    Args:
        configuration: of the run.
        words: of the language.
        mode: "live", "replay" or "report".
    """

    configuration: Configuration
    words: Words
    mode: str
    rates: Rates = field(default_factory=Rates, init=False)
    looked_at: Mapping[str, float] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.looked_at = looked_at_of(self.configuration.motions)

    def cameras(self, told: Told) -> list[dict[str, Any]]:
        """Rows of the table of cameras.

        Args:
            told: the moment; `rates` heard it.
        """
        names = [camera.name for camera in self.configuration.cameras]
        return camera_rows(told, self.words, names, self.rates)

    def moment(self, told: Told, cameras: list[dict[str, Any]]) -> dict[str, Any]:
        """A moment as browsers are told of it.

        Args:
            told: the moment.
            cameras: rows of the table.
        """
        said, judged = headline(told, self.words), told["judged"]
        cycle_ms = sum(judged["stage_ms"].values())
        oldest_ms = judged["oldest_age_ms"]
        level = "unknown" if said.level is None else said.level.name.lower()
        return {
            "sequence": told["sequence"],
            "at": self.words("at", sequence=told["sequence"], time=clock(told["wall_ns"])),
            "age_s": max(0.0, (time.time_ns() - told["wall_ns"]) / 1e9) if self.mode == "live" else 0.0,
            "level": level,
            "word": self.words(f"level.{level}"),
            "sentence": said.sentence,
            "detail": said.detail,
            "motion": said.motion,
            "why": self._why(told, said.motion),
            "motions": motion_rows(told, self.words, self.looked_at),
            "gate": gate_said(told, self.words),
            "path": path_said(told, self.words),
            "cameras": cameras,
            "cycle_ms": cycle_ms,
            "age_ms": None if oldest_ms is None else float(oldest_ms) + cycle_ms,
        }

    def why(self, told: Told, number: int, changes: tuple[Change, ...] | None) -> dict[str, Any]:
        """Why a motion ends where it does, in words.

        Args:
            told: the moment.
            number: of the motion.
            changes: what would change it; None: the cameras were not asked.
        """
        row = with_reach(told["judged"]["verdicts"][number], self.looked_at)
        return {"number": number, **why_text(told, row, self.words, changes)}

    def _why(self, told: Told, motion: int | None) -> dict[str, Any] | None:
        """The worst verdict explained, without asking the cameras; None: nothing is to be explained."""
        rows = told["judged"]["verdicts"]
        if not rows or (motion is None and told["judged"]["stopped_by"] is None):
            return None
        return self.why(told, motion or 0, None)


def clock(wall_ns: int) -> str:
    """The time of day, to the tenth of a second, as this computer's calendar has it.

    Args:
        wall_ns: since 1970 [ns].
    """
    tenths = wall_ns // 100_000_000 % 10
    return f"{time.strftime('%H:%M:%S', time.localtime(wall_ns / 1e9))}.{tenths}"
