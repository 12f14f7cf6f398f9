"""Moments of the simulated room that lie in memory, as a run that goes on and on may be given them."""

import itertools
from dataclasses import replace

import numpy as np

from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources import Room
from elbowroom.sources.simulated import Simulated

UNIT_M = 0.001
"""Of the images of most sensors [m]."""


def in_units(frame: DepthFrame) -> DepthFrame:
    """A frame in whole millimetres, rounded down, as sensors give it.

    Args:
        frame: exact ones [m].
    """
    with np.errstate(invalid="ignore"):
        raw = np.where(np.isfinite(frame.depth_m), np.floor(frame.depth_m / UNIT_M), 0).astype(np.uint16)
    return DepthFrame.from_raw(frame.camera, frame.stamp_ns, raw, scale_m=UNIT_M)


def there_and_back(room: Room, count: int, rate_hz: float) -> list[Snapshot]:
    """Moments of a simulated room that can be played again and again: nothing jumps, and no image follows itself.

    A machine that jumped from the last moment to the first would be stopped, and rightly. So they go back, by
    moments that lie half a period between: a run that leaves some out would else meet the same image again at the
    turn, which is what a camera that is frozen gives.

    Args:
        room: whose source is simulated.
        count: of moments there; one fewer lead back.
        rate_hz: of the cameras.
    """
    assert isinstance(room.source, Simulated)
    there = np.arange(count)
    back = there[:0:-1] - 0.5
    moments = itertools.islice(room.source.at(np.concatenate([there, back]) / rate_hz), 2 * count - 1)
    return [replace(each, frames=tuple(in_units(frame) for frame in each.frames)) for each in moments]
