"""Moments that lie in memory, played again and again as cameras would deliver them: at their rate, on this clock."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from elbowroom.errors import InputError
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources.cadence import Cadence

NS_A_S = 1_000_000_000


@dataclass(frozen=True, slots=True, eq=False)
class FromMemory:
    """A source of moments that were made before. A frame is there the moment that it is exposed; the newest counts.

    Args:
        moments: played one after the other, then from the first on.
        rate_hz: of each camera.
        spread: over which share of a frame period the cameras' exposures are spread; 0: all at once.
        clock_ns: of stamps and of now [ns]; it never goes back.
        sleep: waits [s].

    Raises:
        InputError: no moments, or a rate or spread that cannot be.
    """

    moments: Sequence[Snapshot]
    rate_hz: float = 15.0
    spread: float = 0.0
    clock_ns: Callable[[], int] = time.perf_counter_ns
    sleep: Callable[[float], None] = time.sleep

    def __post_init__(self) -> None:
        if not self.moments or not self.rate_hz > 0 or not 0 <= self.spread < 1:
            raise InputError(
                "frames from memory: at least one moment, a rate above 0, a spread from 0 to below 1"
            )

    @property
    def name(self) -> str:
        """What its time is spent on."""
        return "memory"

    def __iter__(self) -> Iterator[Snapshot]:
        """The newest frame of each camera, whenever there is one that was not given yet and none that is worth a wait
        (`Cadence`).
        """
        start_ns, given, asked_ns, cadence = self.clock_ns(), -1.0, None, Cadence()
        count = len(self.moments[0].frames)
        delays = [self.spread * number / max(1, count) for number in range(count)]
        came = [0] * count
        while True:
            now_ns = self.clock_ns()
            periods = (now_ns - start_ns) * self.rate_hz / NS_A_S
            for number, delay in enumerate(delays):
                while came[number] + delay <= periods:
                    at_ns = start_ns + round((came[number] + delay) * NS_A_S / self.rate_hz)
                    cadence.come(self.moments[0].frames[number].camera, at_ns)
                    came[number] += 1
            newest = max((periods - delay) // 1 + delay for delay in delays)
            later_s = min((periods - delay) // 1 + 1 + delay - periods for delay in delays) / self.rate_hz
            if newest <= given or periods < max(delays):
                self.sleep(max(0.0, later_s))  # exposures come at these times and at no others
                continue
            asked_ns = now_ns if asked_ns is None else asked_ns
            wait_ns = cadence.worth_until_ns(now_ns, asked_ns) - now_ns
            if wait_ns > 0:
                self.sleep(min(wait_ns / NS_A_S, max(0.0, later_s)))
                continue
            given, asked_ns = newest, None
            yield self._at(start_ns, periods, delays)

    def _at(self, start_ns: int, periods: float, delays: Sequence[float]) -> Snapshot:
        frames, joints_of = list[DepthFrame](), {}
        newest = self.moments[int(periods) % len(self.moments)]
        for number, delay in enumerate(delays):
            shown = int((periods - delay) // 1)
            moment = self.moments[shown % len(self.moments)]
            frame = moment.frames[number]
            stamp_ns = start_ns + round((shown + delay) * NS_A_S / self.rate_hz)
            frames.append(replace(frame, stamp_ns=stamp_ns))
            joints = moment.joints_at(frame.camera)
            if joints is not None:
                joints_of[frame.camera] = joints
        return Snapshot(tuple(frames), newest.joints, joints_of, now_ns=self.clock_ns())

    def close(self) -> None:
        """Nothing is held."""
