"""Whether a camera that shares no view with the others looks out of the room that they see."""

from collections.abc import Collection

import numpy as np

from elbowroom.reconstruct.contradiction.eye import Array
from elbowroom.reconstruct.contradiction.pairs import SLACK_M
from elbowroom.reconstruct.contradiction.suspicion import SUSPECT
from elbowroom.reconstruct.contradiction.views import Views

Box = tuple[Array, Array]
"""Lower and upper corner, shape (3,) each [m]."""


def room_of(views: Views, cameras: Collection[int]) -> Box:
    """The box about all that some cameras measured.

    Args:
        views: of a moment.
        cameras: their numbers, at least one of which measured something.
    """
    points = np.concatenate([views.points[camera].in_world for camera in cameras])
    return points.min(axis=0), points.max(axis=0)


def looks_out(views: Views, camera: int, room: Box) -> bool:
    """Whether more of what a camera measured lies outside of a room than makes it a suspect.

    A camera whose pose or lens is wrong looks anywhere. One that hangs over a corner that nobody else looks at, or
    before a cabinet, measures what lies in the room that the others see, and is none that shares no view by mistake.

    Args:
        views: of a moment.
        camera: its number.
        room: as of `room_of`.
    """
    points = views.points[camera]
    slack = (points.wide_m + SLACK_M)[:, None]
    lower, upper = room
    outside = ((points.in_world < lower - slack) | (points.in_world > upper + slack)).any(axis=1)
    return bool(outside.mean() > SUSPECT)
