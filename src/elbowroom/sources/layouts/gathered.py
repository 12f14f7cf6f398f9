"""Images that have times, gathered into moments."""

from collections.abc import Mapping, Sequence

import numpy as np

from elbowroom.sources.layouts.image import Image
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.series import Series


def series_of(rows: Mapping[str, Sequence[Image]]) -> tuple[Series, ...]:
    """When each camera's images were taken; they are by rising time."""
    return tuple(
        Series(name, np.array([image.stamp_ns for image in row], dtype=np.int64))
        for name, row in rows.items()
    )


def gathered(rows: Mapping[str, Sequence[Image]], meeting: Meeting) -> list[list[Image]]:
    """The images of each moment.

    Args:
        rows: by camera, by rising time.
        meeting: of their times.
    """
    return [
        [images[index] for images, index in zip(rows.values(), column, strict=True) if index >= 0]
        for column in meeting.taken().T
    ]
