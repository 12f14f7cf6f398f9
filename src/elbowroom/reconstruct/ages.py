"""How old each camera's claim is when it counts, and how far anything may have moved since."""

from collections.abc import Sequence

from elbowroom.geometry import DepthCamera
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import Snapshot


def aged_m(cameras: Sequence[DepthCamera], snapshot: Snapshot, terms: Terms) -> dict[str, float]:
    """By camera with a frame, how far anything may have moved since it was exposed [m].

    A frame's age is the time between its stamp, the middle of its exposure, and the moment for which verdicts are made,
    before or after; with what its camera's clock may be off, as the site says it and as it was measured, and with the
    time that a pass is assumed to take. A frame without a stamp is taken for one of the moment: nobody knows its age.

    Args:
        cameras: of the room.
        snapshot: frames, and the time now.
        terms: how fast people are, and how long a pass is assumed to take.
    """
    said_ns, measured_ns = (
        {camera.name: camera.clock_bound_ns for camera in cameras},
        snapshot.clock_bounds_ns,
    )
    return {
        frame.camera: terms.people_speed_m_s
        * (
            snapshot.away_ns(frame)
            + said_ns.get(frame.camera, 0)
            + measured_ns.get(frame.camera, 0)
            + terms.pass_ns
        )
        / 1e9
        for frame in snapshot.frames
    }
