"""What a site file says of cameras that are sick."""

from typing import Literal

from elbowroom.site.entry import Entry

CameraCause = Literal[
    "disconnected",
    "gaps",
    "damaged",
    "wrong_size",
    "clock",
    "frozen",
    "swapped",
    "wrong_scale",
    "wrong_encoding",
    "covered",
    "partly_covered",
    "too_old",
]


class HealthEntry(Entry):
    """A sick camera is left out in any case; `tolerated` names the causes for which that alone is done, and no gate
    latches."""

    tolerated: tuple[CameraCause, ...] = ()
