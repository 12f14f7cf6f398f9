"""The latch of a run that goes on: read once, kept up to date, and tried again while it cannot be."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from elbowroom.guard.fault import Fault
from elbowroom.guard.latch import NAME, Kept, Mark, read_latch, write_latch
from elbowroom.guard.reason import Reason

AGAIN_NS = 1_000_000_000
"""What could not be written or taken is tried again after so long [ns]."""


@dataclass(slots=True, eq=False)
class LatchFile:
    """It does not raise: what is wrong with it is a fault.

    Args:
        folder: where it lies.
        site: what it is a latch of; one of another is left as it is.
    """

    folder: Path
    site: str
    fault: Fault | None = field(default=None, init=False)
    _is_ours: bool = field(default=True, init=False)
    _on_disk: tuple[Fault, ...] | None = field(default=None, init=False)
    _tried_ns: int | None = field(default=None, init=False)

    def begin(self) -> tuple[Fault, ...]:
        """What it holds from the run before."""
        return self._taken().faults

    def keep(self, latched: Sequence[Fault], now_ns: int) -> None:
        """Brings what is latched to disk, if it is not there yet; `fault` says why it cannot be.

        Args:
            latched: faults since the last reset; none: the run goes on, which a later one reads as latched too.
            now_ns: the time [ns].
        """
        wanted = tuple(latched)
        if self.fault is None and self._is_on_disk(wanted):
            return
        if self.fault is not None and self._tried_ns is not None and now_ns - self._tried_ns < AGAIN_NS:
            return
        self._tried_ns = now_ns
        if not self._is_ours and not self._taken().is_ours:
            return
        try:
            write_latch(self._path, self.site, Mark.LATCHED if wanted else Mark.RUNNING, wanted)
        except OSError as error:
            self._on_disk = None
            text = (
                f"{self._path}: the latch cannot be written ({error.strerror}), so the machine stays stopped"
            )
            self.fault = Fault(Reason.LATCH_FILE, "", text)
            return
        self._on_disk, self.fault = wanted, None

    def end(self, latched: Sequence[Fault]) -> None:
        """Leaves it for the next run: unlatched alone where nothing is latched, and it could be kept all along."""
        if not self._is_ours or self.fault is not None:
            return
        with suppress(OSError):  # what is on disk then is latched too
            write_latch(self._path, self.site, Mark.LATCHED if latched else Mark.ENDED, latched)

    @property
    def _path(self) -> Path:
        return self.folder / NAME

    def _taken(self) -> Kept:
        """Reads it; a file that is not ours is a fault for as long as it lies there."""
        kept = read_latch(self._path, self.site)
        self._is_ours = kept.is_ours
        self.fault = None if kept.is_ours else kept.faults[0]
        return kept

    def _is_on_disk(self, wanted: tuple[Fault, ...]) -> bool:
        """Whether the same faults stand there, in the same order; the words of the first time stay."""
        return self._on_disk == wanted
