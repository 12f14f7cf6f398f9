"""What latches."""

from dataclasses import dataclass, field

from elbowroom.errors import InputError
from elbowroom.guard.reason import Reason


@dataclass(frozen=True, slots=True)
class Fault:
    """Something for which the machine stops until a person resets.

    Args:
        reason: its kind.
        subject: the camera or part that it is about; empty: none.
        text: what was found, one sentence; two faults of one reason and subject are the same one, whatever the text.

    Raises:
        InputError: the reason is none that latches.
    """

    reason: Reason
    subject: str = ""
    text: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        if not self.reason.is_fault:
            raise InputError(f"gate: {self.reason.name} is no fault")

    @property
    def sentence(self) -> str:
        """What an operator reads."""
        return self.text or self.reason.sentence
