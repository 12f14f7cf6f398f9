"""The look at a source that plays: what it says itself is odd about what it gives."""

from dataclasses import dataclass

from elbowroom.finding import Finding
from elbowroom.sensing import Snapshot
from elbowroom.sources import Played


@dataclass(frozen=True, slots=True, eq=False)
class SourceLook:
    """Says what the source found about its last snapshot: clocks, images that are damaged or left out (`Look`).

    Args:
        source: of the run.
    """

    source: Played

    @property
    def name(self) -> str:
        """In a word, for the table of stages."""
        return "source"

    def hear(self, snapshot: Snapshot) -> tuple[Finding, ...]:
        """What was found, each time again while it lasts."""
        return self.source.findings
