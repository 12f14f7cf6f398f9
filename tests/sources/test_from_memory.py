"""Moments in memory, played as cameras would deliver them."""

import itertools

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources.from_memory import FromMemory


def moment(number, cameras=3):
    image = np.full((2, 2), 1.0 + number, np.float32)
    return Snapshot(tuple(DepthFrame(f"c{n}", 0, image) for n in range(cameras)), {"slide": float(number)})


class Clock:
    """Time that goes on while somebody sleeps, or works."""

    def __init__(self):
        self.now_ns = 5_000_000_000

    def __call__(self):
        return self.now_ns

    def sleep(self, seconds):
        self.now_ns += round(seconds * 1e9) + 1000


@pytest.mark.parametrize("spread", (0.0, 0.9))
def test_frames_come_when_they_are_exposed_and_the_newest_counts(spread):
    clock = Clock()
    source = FromMemory([moment(n) for n in range(4)], 10.0, spread, clock, clock.sleep)
    start_ns, ages = clock.now_ns, []
    for snapshot in itertools.islice(source, 12):
        for frame in snapshot.frames:
            assert 0 <= snapshot.now_ns - frame.stamp_ns <= 100_000_000 + 10_000
            shown = (frame.stamp_ns - start_ns) // 100_000_000
            assert frame.depth_m[0, 0] == 1.0 + shown % 4
            assert snapshot.joints_of[frame.camera] == {"slide": float(shown % 4)}
        ages.append(min(snapshot.now_ns - frame.stamp_ns for frame in snapshot.frames))
        clock.now_ns += 7_000_000
    # whoever is fast waits for the next exposure
    assert max(ages[1:]) < 8_000_000
    assert (np.ptp([frame.stamp_ns for frame in snapshot.frames]) > 0) == (spread > 0)


def test_who_is_slow_misses_frames_and_never_gets_one_twice():
    clock = Clock()
    source = FromMemory([moment(n) for n in range(9)], 10.0, 0.0, clock, clock.sleep)
    stamps = []
    for snapshot in itertools.islice(source, 5):
        stamps.append(snapshot.frames[0].stamp_ns)
        clock.now_ns += 250_000_000
    assert (np.diff(stamps) > 100_000_000).all()


@pytest.mark.parametrize("wrong", [{"moments": []}, {"rate_hz": 0.0}, {"spread": 1.0}])
def test_what_cannot_be_played_is_refused(wrong):
    with pytest.raises(InputError, match="memory"):
        FromMemory(**{"moments": [moment(0)], **wrong})
