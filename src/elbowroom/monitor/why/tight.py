"""Links beside which a surface is nearer than cameras can tell: their motions are stopped as long as it is there."""

from collections.abc import Sequence
from dataclasses import dataclass

from elbowroom.monitor.why.why import Why, why
from elbowroom.motion import Level, Motion, Verdict, check_motions
from elbowroom.reconstruct import FreeSpace
from elbowroom.sensing import Snapshot
from elbowroom.sources import Room


@dataclass(frozen=True, slots=True, eq=False)
class Tight:
    """A link that has a surface beside it, within the margin.

    Args:
        link: its name.
        stopped: names of the motions that this stops.
        distance_m: of the surface from the link [m].
        margin_m: the widest margin of the cameras there [m].
        cameras: their names.
    """

    link: str
    stopped: tuple[str, ...]
    distance_m: float
    margin_m: float
    cameras: tuple[str, ...]

    def __str__(self) -> str:
        return (
            f"link {self.link}: a surface {1e3 * self.distance_m:.0f} mm from it lies within the margin of "
            f"{', '.join(self.cameras)} (up to {1e3 * self.margin_m:.0f} mm there), so {', '.join(self.stopped)} "
            "will be stopped as long as it is there; nearer cameras or less noise change that"
        )


def tight_places(room: Room, snapshot: Snapshot) -> tuple[Tight, ...]:
    """Where a motion is stopped at once, and nothing is in its way but what lies within the margin.

    Args:
        room: with a machine and speeds.
        snapshot: a moment of it.

    Raises:
        InputError: no machine, no speeds, or images that cannot be used.
    """
    machine, motions = room.machine_and_motions()
    space = room.space_of(snapshot)
    joints = snapshot.joints or {}
    verdicts = check_motions(space, machine, joints, motions)
    stopped = [verdict for verdict in verdicts if verdict.level is Level.STOP]
    return _by_link(
        [why(space, machine, joints, verdict) for verdict in _told_apart(space, stopped)], stopped
    )


def _told_apart(space: FreeSpace, stopped: Sequence[Verdict]) -> list[Verdict]:
    """One verdict of each link and voxel: the others say the same."""
    first: dict[tuple[str | None, tuple[int, ...]], Verdict] = {}
    for verdict in stopped:
        place = verdict.place_in_world
        if place is not None and space.grid.contains(place):
            first.setdefault((verdict.link, tuple(space.grid.index_of(place))), verdict)
    return list(first.values())


def _by_link(found: Sequence[Why], stopped: Sequence[Verdict]) -> tuple[Tight, ...]:
    tight: dict[str, list[Why]] = {}
    for one in found:
        if one.is_the_margin and one.verdict.link is not None:
            tight.setdefault(one.verdict.link, []).append(one)
    return tuple(
        Tight(
            link,
            tuple(v.motion.name for v in stopped if v.link == link and isinstance(v.motion, Motion)),
            min(one.outside_m or 0.0 for one in ones),
            max(camera.margin_m for one in ones for camera in one.measuring),
            tuple(dict.fromkeys(camera.camera for one in ones for camera in one.measuring)),
        )
        for link, ones in tight.items()
    )
