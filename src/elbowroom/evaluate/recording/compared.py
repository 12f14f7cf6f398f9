"""What was written beside what was given, looked at in another process while the run goes on."""

import hashlib
import os
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from numpy.typing import NDArray

from elbowroom.monitor.blackbox.recording import Recording

LOOKED_AT = 7
"""Every so many passes are compared with what was given."""
Sums = Sequence[Sequence[bytes]]


def sum_of(image: NDArray[Any]) -> bytes:
    """What stands for an image."""
    return hashlib.sha256(image.data).digest()


def compared(file: Path, sums: Sums) -> tuple[int, int, int]:
    """Looks at a file, and takes it away.

    Args:
        file: a recording; the moment of a pass follows from its number.
        sums: of each moment, those of its images.

    Returns:
        How many passes it holds, how many images of every `LOOKED_AT`th are not as they were given (one more where the
        chain is broken), and its size [bytes].
    """
    other, size = 0, file.stat().st_size
    with Recording(file) as recording:
        for number in range(0, len(recording), LOOKED_AT):
            one = recording.at(number)
            due = sums[one.sequence % len(sums)]
            found = [sum_of(frame.depth_m) for frame in one.snapshot.frames]
            other += sum(now != then for now, then in zip(found, due, strict=True))
        kept, other = len(recording), other + (recording.wrong() is not None)
    file.unlink()
    return kept, other, size


class Comparing:
    """Looks at files one after the other, in a process that gives way to all others.

    Args:
        sums: as of `compared`.
    """

    def __init__(self, sums: Sums) -> None:
        self._sums = sums
        self._pool = ProcessPoolExecutor(1, get_context("spawn"), os.nice, (19,))
        self._looks: list[Future[tuple[int, int, int]]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pool.shutdown(cancel_futures=True)

    def take(self, *files: Path) -> None:
        """More files; it does not wait."""
        self._looks += [self._pool.submit(compared, file, self._sums) for file in files]

    def found(self) -> tuple[int, int, int]:
        """Of all files together, once they are looked at: as of `compared`."""
        kept, other, size = zip(*(look.result() for look in self._looks), strict=True)
        return sum(kept), sum(other), sum(size)
