"""Why an image gives no view of the board."""

from dataclasses import dataclass
from enum import Enum


class Fault(Enum):
    """What was wrong; the value is the sentence that a person reads."""

    NOT_SEEN = "no board is seen"
    HALF_SEEN = "a part of the board lies outside the image or is hidden"
    MIRRORED = "the mark is on the wrong side: the board shows its back, or the image is mirrored"
    MISREAD = (
        "the board seems to be elsewhere than other cameras agree that it is: misread, or moved meanwhile"
    )
    WRONG_SIZE = "a board is seen, but of another size than the site says"
    WRONG_COUNT = "a board is seen, but with another number of corners than the site says"


@dataclass(frozen=True, slots=True)
class Trouble:
    """An image that gave no view.

    Args:
        camera: name.
        pose: which pose of the board.
        fault: what was wrong.
        detail: what was found, such as "squares of 0.080 m"; may be empty.
    """

    camera: str
    pose: int
    fault: Fault
    detail: str = ""

    def __str__(self) -> str:
        more = f" ({self.detail})" if self.detail else ""
        return f"camera {self.camera}, pose {self.pose}: {self.fault.value}{more}"
