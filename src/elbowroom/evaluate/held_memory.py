"""Whether the memory of a process grows: what it holds, second by second, and the slope of that with its interval."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

SETTLES = 0.25
"""So much of a run is not looked at: caches fill, and the black box [share]."""
BLOCK_S = 20.0
"""Seconds next to each other are no evidence of their own; the medians of such blocks are."""
FEWEST = 5
"""Of fewer blocks no slope is said."""
CONFIDENCE = 0.95


class Slope(NamedTuple):
    """How fast it grows.

    Args:
        mb_per_hour: the median of the slopes between any two blocks (Theil and Sen).
        low, high: of its interval (Sen, 1968) [MB per hour].
    """

    mb_per_hour: float
    low: float
    high: float


def resident_mb() -> float | None:
    """What this process holds in memory [MB]; None: the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except (OSError, ValueError, IndexError):
        return None
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def slope_of(times_s: Sequence[float], held_mb: Sequence[float]) -> Slope | None:
    """The slope of what is held, with its interval of 95 %; None: too short to say.

    Args:
        times_s: of each look, shape (n,), from the beginning of the run [s].
        held_mb: what was held then, shape (n,) [MB].
    """
    from scipy.stats import theilslopes

    times, held = np.asarray(times_s, float), np.asarray(held_mb, float)
    if times.size == 0:
        return None
    block = ((times - SETTLES * times[-1]) // BLOCK_S).astype(int)
    whole = [number for number in range(block.max() + 1) if (block == number).sum() >= BLOCK_S / 2]
    if len(whole) < FEWEST:
        return None
    middle = [float(np.median(times[block == number])) for number in whole]
    found = theilslopes([float(np.median(held[block == number])) for number in whole], middle, CONFIDENCE)
    return Slope(*(3600 * float(value) for value in (found.slope, found.low_slope, found.high_slope)))


def words_of_slope(row: Mapping[str, Any]) -> str:
    """What a row with a slope says of it: "+0.2 MB/h (-1.1 to 1.4)"; "" where the run was too short."""
    if row.get("slope_mb_per_hour") is None:
        return ""
    return f"{row['slope_mb_per_hour']:+.1f} MB/h ({row['slope_low']:+.1f} to {row['slope_high']:+.1f})"


@dataclass(slots=True, eq=False)
class Watched:
    """Looks at what this process holds, once a second, into memory that is there before.

    Args:
        seconds: how long it may be.
    """

    seconds: float
    _table: np.ndarray = field(init=False)
    _many: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self._table = np.full((int(self.seconds) + 120, 2), np.nan)

    def look(self, now_s: float) -> None:
        """Looks, if a second has gone by.

        Args:
            now_s: since the beginning of the run [s].
        """
        held = resident_mb() if self._many <= now_s and self._many < len(self._table) else None
        if held is not None:
            self._table[self._many] = now_s, held
            self._many += 1

    @property
    def newest_mb(self) -> float | None:
        """What was held at the last look."""
        return float(self._table[self._many - 1, 1]) if self._many else None

    def row(self) -> dict[str, float | int | None]:
        """What came of it, for a row."""
        times, held = self._table[: self._many].T
        slope = slope_of(times, held)
        return {
            "resident_mb": self.newest_mb,
            "slope_mb_per_hour": None if slope is None else slope.mb_per_hour,
            "slope_low": None if slope is None else slope.low,
            "slope_high": None if slope is None else slope.high,
            "grows": None if slope is None else int(slope.low > 0),
        }
