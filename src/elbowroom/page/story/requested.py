"""The path that a machine was asked to take, as the page draws it: where it leads, and where it ends."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.motion import Level
from elbowroom.page.story.told import Told

STOPS = 24
"""At so many places along its way the machine is looked at."""
AHEAD_S = 2.0
"""So far ahead a path is drawn, and as far as it was looked at [s]."""


def level_of_path(told: Told) -> Level | None:
    """The level of the path that was asked for; None: none was, or it is over.

    Args:
        told: the moment.
    """
    if told.get("path") is None:
        return None
    if told["judged"].get("off_path") is not None:
        return Level.STOP
    row = told["judged"].get("path")
    return None if row is None else Level[str(row["level"]).upper()]


def end_of_path(told: Told) -> Mapping[str, Any] | None:
    """What ends the part of the path that may be followed; None: nothing does, as far as was looked.

    Args:
        told: the moment.
    """
    row = told["judged"].get("path") or {}
    first: Mapping[str, Any] | None = row.get("stop_blocked") or row.get("blocked")
    return first


def poses_of_path(told: Told) -> list[dict[str, float]]:
    """Joint positions along the path that was asked for, beyond where it is blocked as well: it is seen where it leads.

    Args:
        told: the moment; where its joints are is known.
    """
    path, row = told["path"], told["judged"].get("path")
    times = np.array(path["times_s"])
    begin_s = max(float(times[0]), 0.0) if row is None else row["begin_s"]
    end_s = max(begin_s + AHEAD_S, begin_s if row is None else row["looked_until_s"])
    columns = np.array(path["positions"], dtype=np.float64).reshape(len(times), -1).T
    looked = np.linspace(begin_s, max(min(end_s, float(times[-1])), begin_s), STOPS)
    places: list[NDArray[np.float64]] = [np.interp(looked, times, column) for column in columns]
    named = dict(zip(path["joint_names"], places, strict=True))
    return [
        {**told["joints"], **{name: float(values[n]) for name, values in named.items()}} for n in range(STOPS)
    ]
