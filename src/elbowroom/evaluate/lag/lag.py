"""Runs of the closed loop, part by part, and what they come to."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.lag.loop import TICK_S, Setting, Tick, run_loop
from elbowroom.evaluate.lag.moves import Moves, find_moves
from elbowroom.evaluate.lag.windows import Window, needless_of, share_pct, windows_of
from elbowroom.evaluate.shares.work_force import do_work
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Level, Motion

PART_S = 150.0
"""A run is cut into parts of so much simulated time, each with choices and noise of its own [s]."""
MOVES = 60
SKEWS_MS = (0.0, 67.0)
TOUCHING_M = 1e-4
DUE = (
    Due("missed", "≤", 0, words="windows in which it should have stopped and did not"),
    Due("touched", "≤", 0, words="people touched by a machine that moves"),
)


@dataclass(frozen=True, slots=True, eq=False)
class _Asked:
    """A motion over the time in which it is asked: by tick, whether it should be stopped, and whether it is."""

    should: NDArray[np.bool_]
    stopped: NDArray[np.bool_]


def lag_rows(
    minutes: float = 30.0,
    skews_ms: Sequence[float] = SKEWS_MS,
    seed: int = 1,
    setting: Setting | None = None,
    jobs: int = 1,
) -> Iterator[dict[str, Any]]:
    """Simulated minutes of the closed loop, as often as there are skews.

    Two rows a part: of all motions, whether the machine makes them or not, and of that alone which it is about to make.

    Args:
        minutes: of simulated time for each skew.
        skews_ms: between the exposures of a pass [ms].
        seed: of moves, choices and noise.
        setting: of cameras and voxels; None: small ones.
        jobs: so many processes share the parts; the rows are the same, in another order.

    Yields:
        Rows of kind "part"; `lags_ms` are of windows in which it was stopped at all.

    Raises:
        PackageError: coal is not installed.
    """
    work = [
        partial(_part, replace(setting or Setting(), skew_ms=skew_ms), minutes, part, seed)
        for skew_ms in skews_ms
        for part in range(parts_of(minutes))
    ]
    for _, rows in do_work(work, jobs=jobs):
        yield from rows


def _part(setting: Setting, minutes: float, part: int, seed: int) -> list[dict[str, Any]]:
    """The rows of one part."""
    seconds = min(PART_S, 60 * minutes - part * PART_S)
    ticks = list(run_loop(setting, _moves(seed), seconds, seed + part))
    asked = {"every motion": _every(ticks), "the machine's own": _own(ticks)}
    return [
        {**_said(setting, part, seed, ticks), "which": which, **_counted(each, setting)}
        for which, each in asked.items()
    ]


@cache
def _moves(seed: int) -> Moves:
    return find_moves(ceiling_c_arm(), MOVES, np.random.default_rng(seed))


def parts_of(minutes: float) -> int:
    """How many parts so many simulated minutes have."""
    return max(1, int(np.ceil(60 * minutes / PART_S - 1e-9)))


def _said(setting: Setting, part: int, seed: int, ticks: Sequence[Tick]) -> dict[str, Any]:
    moving = [tick for tick in ticks if tick.share > 0]
    return {
        "kind": "part",
        "skew_ms": setting.skew_ms,
        "part": part,
        "seed": seed + part,
        "seconds": len(ticks) * TICK_S,
        "voxel_size_m": setting.voxel_size_m,
        "cameras": setting.cameras,
        "width": setting.size[0],
        "height": setting.size[1],
        "people_speed_m_s": setting.people_speed_m_s,
        "ahead": setting.ahead,
        "reaction_ms": 1e3 * setting.reaction_ticks * TICK_S,
        "moving_s": len(moving) * TICK_S,
        "touched": sum(tick.gap_m < TOUCHING_M for tick in moving),
        "least_gap_mm": 1e3 * min((tick.gap_m for tick in moving), default=float("inf")) if moving else None,
    }


def _is_stopped(tick: Tick, motion: Motion) -> bool:
    return tick.levels.get(motion, Level.STOP) is Level.STOP


def _every(ticks: Sequence[Tick]) -> list[_Asked]:
    """Each motion over the whole time, by what people are in the way of."""
    motions = list(ticks[-1].levels)
    return [
        _Asked(
            np.array([motion in tick.contacts for tick in ticks]),
            np.array([_is_stopped(tick, motion) for tick in ticks]),
        )
        for motion in motions
    ]


def _own(ticks: Sequence[Tick]) -> list[_Asked]:
    """The motion that the machine is about to make, cut where that changes."""
    active = [tick.active.name for tick in ticks]
    cuts = [0, *(n for n in range(1, len(ticks)) if active[n] != active[n - 1]), len(ticks)]
    return [
        _Asked(
            np.array([tick.active in tick.contacts for tick in ticks[a:b]]),
            np.array([_is_stopped(tick, tick.active) for tick in ticks[a:b]]),
        )
        for a, b in itertools.pairwise(cuts)
    ]


def _counted(asked: Sequence[_Asked], setting: Setting) -> dict[str, Any]:
    windows, needless, ticks, stopped = list[Window](), list[tuple[int, int]](), 0, 0
    for each in asked:
        windows += windows_of(each.should, each.stopped, setting.reaction_ticks)
        needless += needless_of(each.should, each.stopped, setting.reaction_ticks)
        ticks, stopped = ticks + each.should.size, stopped + int(each.stopped.sum())
    lags = [1e3 * TICK_S * window.lag for window in windows if window.lag is not None]
    return {
        "windows": len(windows),
        "missed": sum(window.is_missed for window in windows),
        "stopped_before": sum(window.lag == 0 for window in windows),
        "never_stopped": sum(window.lag is None for window in windows),
        "lags_ms": [round(lag, 1) for lag in lags if lag > 0],
        "needless": len(needless),
        "needless_pct": share_pct(needless, ticks),
        "stopped_pct": 100 * stopped / max(1, ticks),
    }


SUMMED = (
    "seconds",
    "moving_s",
    "touched",
    "windows",
    "missed",
    "stopped_before",
    "never_stopped",
    "needless",
)
SAME = (
    "skew_ms",
    "which",
    "voxel_size_m",
    "cameras",
    "width",
    "height",
    "people_speed_m_s",
    "ahead",
    "reaction_ms",
)


def lag_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row of kind "lag" for each skew, of all motions and of the machine's own.

    Args:
        rows: of `lag_rows`.
    """
    groups = dict[tuple[float, str], list[Mapping[str, Any]]]()
    for row in rows:
        groups.setdefault((row["skew_ms"], row["which"]), []).append(row)
    summary = []
    for _, own in sorted(groups.items()):
        lags = [lag for row in own for lag in row["lags_ms"]]
        seconds = sum(row["seconds"] for row in own)
        summary.append(
            {
                "kind": "lag",
                **{key: own[0][key] for key in SAME},
                **{key: sum(row[key] for row in own) for key in SUMMED},
                "minutes": seconds / 60,
                "late": len(lags),
                "lag_median_ms": float(np.median(lags)) if lags else None,
                "lag_worst_ms": max(lags, default=None),
                "needless_pct": sum(row["needless_pct"] * row["seconds"] for row in own) / seconds,
                "stopped_pct": sum(row["stopped_pct"] * row["seconds"] for row in own) / seconds,
                "least_gap_mm": min(
                    (row["least_gap_mm"] for row in own if row["least_gap_mm"] is not None), default=None
                ),
            }
        )
    return summary
