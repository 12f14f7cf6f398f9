"""What a machine means to do, as whoever drives it says it: joint positions at times of the frames' clock."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import JointsError

BACK_NS, ON_NS = 200_000_000, 5_000_000_000
"""Of a long path so much before and after a moment is handed on with it [ns]."""


@dataclass(frozen=True, slots=True, eq=False)
class MeantPath:
    """Joint positions at rising times. Before the first one the machine stands there; after the last one it is over.

    Args:
        joint_names: each once.
        stamps_ns: of the points, int64, strictly rising, shape (n,), n at least 1 [ns, the clock of the frames].
        positions: at these times, shape (n, joints) [m or rad].
        velocities: likewise [m/s or rad/s]; None: between two points joints go straight.
        said_ns: when it was said [ns]: it counts from then on, in place of the one before; None: from the beginning.

    Raises:
        JointsError: shapes that do not fit, times that do not rise, a number that is not finite.
    """

    joint_names: tuple[str, ...]
    stamps_ns: NDArray[np.int64]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64] | None = None
    said_ns: int | None = None

    def __post_init__(self) -> None:
        names, stamps = tuple(self.joint_names), np.array(self.stamps_ns, dtype=np.int64)
        if not names or len(set(names)) != len(names):
            raise JointsError(f"path: joint names are {list(names)}, must be at least one, each once")
        if stamps.ndim != 1 or not len(stamps) or (np.diff(stamps) <= 0).any():
            raise JointsError("path: times must be one or more, and strictly rise")
        object.__setattr__(self, "joint_names", names)
        object.__setattr__(self, "stamps_ns", _read_only(stamps))
        shape = (len(stamps), len(names))
        object.__setattr__(self, "positions", _table("positions", self.positions, shape))
        if self.velocities is not None:
            object.__setattr__(self, "velocities", _table("velocities", self.velocities, shape))

    @property
    def end_ns(self) -> int:
        """Time of the last point [ns]."""
        return int(self.stamps_ns[-1])

    def about(self, now_ns: int, back_ns: int = BACK_NS, on_ns: int = ON_NS) -> Self:
        """The points about a moment, and the next one on either side.

        Args:
            now_ns: the moment [ns].
            back_ns, on_ns: how far before and after it [ns].
        """
        first = max(int(np.searchsorted(self.stamps_ns, now_ns - back_ns, side="right")) - 1, 0)
        last = int(np.searchsorted(self.stamps_ns, now_ns + on_ns, side="left")) + 1
        part = slice(min(first, len(self.stamps_ns) - 1), max(last, first + 1))
        speeds = None if self.velocities is None else self.velocities[part]
        return replace(
            self, stamps_ns=self.stamps_ns[part], positions=self.positions[part], velocities=speeds
        )


@dataclass(frozen=True, slots=True, eq=False)
class MeantPaths:
    """All paths of a run.

    Args:
        paths: in the order in which they were said.
        begins: their times count from the first moment that is asked for, which is their 0; else they are times of the
            frames' clock.
    """

    paths: Sequence[MeantPath]
    begins: bool = False

    def at(self, now_ns: int, first_ns: int) -> MeantPath | None:
        """The last one that was said by now, as far as it counts now; None: none was, or it is over.

        Args:
            now_ns: the moment [ns, the clock of the frames].
            first_ns: the first moment of the run [ns].
        """
        zero_ns = first_ns if self.begins else 0
        said = [path for path in self.paths if path.said_ns is None or path.said_ns <= now_ns]
        if not said or now_ns > said[-1].end_ns + zero_ns + BACK_NS:
            return None
        return replace(said[-1], stamps_ns=said[-1].stamps_ns + zero_ns).about(now_ns)


def _table(what: str, given: ArrayLike, shape: tuple[int, int]) -> NDArray[np.float64]:
    values = np.array(given, dtype=np.float64)
    if values.shape != shape or not np.isfinite(values).all():
        raise JointsError(f"path: {what} have shape {values.shape}, must be finite and have {shape}")
    return _read_only(values)


def _read_only(values: NDArray) -> NDArray:
    values.setflags(write=False)
    return values
