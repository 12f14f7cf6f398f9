"""A recorded pass, judged again so that its space can be looked at."""

from dataclasses import dataclass, replace
from typing import Any

from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.blackbox.recording import RecordedPass, Recording
from elbowroom.monitor.why.changes import Change
from elbowroom.page.asking import changes_in, verdict_of
from elbowroom.page.story.told import told_of_recorded
from elbowroom.reconstruct import FreeSpace


@dataclass(frozen=True, slots=True, eq=False)
class Again:
    """A pass of a recording.

    Args:
        index: in the file, from 0.
        told: what is said of it.
        space: its free space, with its images; None: nothing was judged.
    """

    index: int
    told: dict[str, Any]
    space: FreeSpace | None


@dataclass(slots=True, eq=False)
class Judge:
    """Judges passes of a recording again, one at a time.

    Args:
        recording: the file.
        configuration: of it.
    """

    recording: Recording
    configuration: Configuration

    def told(self, index: int) -> tuple[dict[str, Any], RecordedPass]:
        """What is said of a pass, at once.

        Args:
            index: in the file, from 0.

        Raises:
            BagError: it cannot be read.
        """
        one = self.recording.at(index)
        return told_of_recorded(one), one

    def again(self, told: dict[str, Any], one: RecordedPass) -> Again:
        """A pass with its space.

        Args:
            told, one: of `told`.
        """
        given = one.judged["given"]
        if given is None:
            return Again(one.number, told, None)
        frames = tuple(frame for frame in one.snapshot.frames if frame.camera in given)
        result = self.configuration.cycle(keeps_images=True).run(replace(one.snapshot, frames=frames))
        return Again(one.number, told, result.space)

    def changes(self, of: Again, number: int) -> tuple[Change, ...] | None:
        """What would change a verdict; None: no image can say.

        Args:
            of: the pass.
            number: of the motion.
        """
        row = of.told["judged"]["verdicts"][number]
        stopped_by = of.told["judged"]["stopped_by"]
        if of.space is None or stopped_by is not None or self.configuration.machine is None:
            return None
        verdict = verdict_of(row, self.configuration.motions[number])
        return changes_in(of.space, self.configuration, of.told["joints"] or {}, verdict)
