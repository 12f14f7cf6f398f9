"""What is said where stamps of joints are not of when they come."""

from elbowroom.sources.times.clock import ClockEstimate
from elbowroom.sources.times.series import length_text

LATE_NS = 100_000_000
"""Joints of which the quickest come later than this after their stamps are said to be late [ns]."""


def joint_clock_text(topic: str, estimate: ClockEstimate) -> str | None:
    """That the stamps of a topic of joints are not of when they come; None: they may well be.

    Args:
        topic: its name.
        estimate: of its clock beside that of the recorder.
    """
    apart = length_text(estimate.offset_ns)
    if estimate.offset_ns < -estimate.bound_ns:
        return (
            f"{topic}: its stamps are {apart} ahead of when joints come: its clock is ahead; where it is played, they "
            "are taken back by that"
        )
    if estimate.offset_ns > LATE_NS:
        return (
            f"{topic}: joints come {apart} after their stamps at the quickest: they are late, or their clock is "
            "behind; where the machine was when an image was taken may be wrong by what it moves in that time"
        )
    return None
