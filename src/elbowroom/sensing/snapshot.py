"""What came at one moment: frames, and where the machine was, asked once where frames come in."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

from elbowroom.errors import InputError
from elbowroom.sensing.frame import DepthFrame
from elbowroom.sensing.joints import JointRecord
from elbowroom.sensing.meant import MeantPath

Positions = Mapping[str, float]
"""Joint positions by name [m or rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """Newest frames of a room at one moment, and where the machine was.

    Args:
        frames: the newest frame of each camera that has one.
        joints: where the machine is now, by name [m or rad]; motions begin there; None: there is no machine, or
            nobody knows.
        joints_of: by camera, where the machine was at the time of its frame; a camera that is missing: as `joints`.
        now_ns: the time now [ns, the clock of the frames]; None: nothing has a time.
        clock_bounds_ns: by camera, how much older its frame may be than its stamp says, since its clock is known no
            better [ns]; a camera that is missing: not at all. It is part of every age.
        joints_ns: when `joints` were so [ns, the clock of the frames]; None: nobody says.
        commanded: at which speeds the machine is commanded to move, by joint [m/s or rad/s]; None: nobody says.
        velocities: how fast joints are now, by name [m/s or rad/s]; of a joint that is missing nobody knows.
        path: what the machine means to do, as far as it is said; None: nothing is, or nothing is left of it.
    """

    frames: tuple[DepthFrame, ...]
    joints: Positions | None = None
    joints_of: Mapping[str, Positions] = field(default_factory=dict)
    now_ns: int | None = None
    clock_bounds_ns: Mapping[str, int] = field(default_factory=dict)
    joints_ns: int | None = None
    commanded: Positions | None = None
    velocities: Positions = field(default_factory=dict)
    path: MeantPath | None = None

    @classmethod
    def taken(
        cls,
        frames: Sequence[DepthFrame],
        joints: Positions | JointRecord | None = None,
        now_ns: int | None = None,
        max_age_ns: int | None = None,
    ) -> Self:
        """A moment from frames and joints, a record of joints asked at each frame's time.

        Args:
            frames: at most one of each camera.
            joints: positions that hold throughout, or a record; then *now* is the newest frame's time, or `now_ns`
                where no frame has one.
            now_ns: the time now [ns, the clock of the frames].
            max_age_ns: of frames past this age the record is not asked [ns]: it may reach back no farther; None: of
                all it is.

        Raises:
            InputError: a record, and a frame without a time, or neither frames nor the time; an age limit without the
                time, or one below zero.
            JointsError: the record knows nothing of a frame's time.
        """
        if not isinstance(joints, JointRecord):
            return cls(tuple(frames), joints, {}, now_ns)
        young = young_enough(frames, now_ns, max_age_ns)
        joints_of = {frame.camera: _asked(joints, frame) for frame in young}
        newest = max((frame.stamp_ns for frame in young if frame.stamp_ns is not None), default=now_ns)
        if newest is None:
            raise InputError("joints: a record needs frames with times, or now_ns")
        speeds = joints.velocities_at(newest)
        return cls(tuple(frames), joints.at(newest), joints_of, now_ns, velocities=speeds)

    def joints_at(self, camera: str) -> Positions | None:
        """Where the machine was at the time of a camera's frame, by name [m or rad]; None: not known."""
        return self.joints_of.get(camera, self.joints)

    @property
    def joints_at_newest(self) -> Positions | None:
        """Where the machine was at the time of the newest frame, by name [m or rad]; of none: as `joints`."""
        timed = [frame for frame in self.frames if frame.stamp_ns is not None]
        if not timed:
            return self.joints
        return self.joints_at(max(timed, key=lambda frame: frame.stamp_ns or 0).camera)

    def fresh(self, max_age_ns: int | None) -> Self:
        """The same moment with those frames alone that are within an age limit.

        A frame is left out that is older, that is so far ahead of the clock, or that has no time.

        Args:
            max_age_ns: the limit [ns]; None: none, every frame stays.

        Raises:
            InputError: an age limit without the time now, or one below zero.
        """
        kept = young_enough(self.frames, self.now_ns, max_age_ns, self.clock_bounds_ns)
        return replace(self, frames=tuple(kept))

    @property
    def moment_ns(self) -> int | None:
        """The moment that what is seen is said of: now, or else the newest frame's time; None: nothing has a time."""
        if self.now_ns is not None:
            return self.now_ns
        return max((frame.stamp_ns for frame in self.frames if frame.stamp_ns is not None), default=None)

    def away_ns(self, frame: DepthFrame) -> int:
        """Between a frame and the moment, before or after [ns]; 0 where either has no time."""
        moment_ns = self.moment_ns
        return 0 if moment_ns is None or frame.stamp_ns is None else abs(moment_ns - frame.stamp_ns)

    @property
    def oldest_age_ms(self) -> float | None:
        """Age of the oldest frame [ms]; None: no frame has a time, or nobody knows the time now."""
        bounds = self.clock_bounds_ns
        earliest = [f.stamp_ns - bounds.get(f.camera, 0) for f in self.frames if f.stamp_ns is not None]
        return (self.now_ns - min(earliest)) / 1e6 if earliest and self.now_ns is not None else None

    @property
    def skew_ms(self) -> float | None:
        """Between the stamps of the oldest and the newest frame [ms]; None: fewer than two have one."""
        stamps = [frame.stamp_ns for frame in self.frames if frame.stamp_ns is not None]
        return (max(stamps) - min(stamps)) / 1e6 if len(stamps) > 1 else None


def young_enough(
    frames: Sequence[DepthFrame],
    now_ns: int | None,
    max_age_ns: int | None,
    clock_bounds_ns: Mapping[str, int] | None = None,
) -> list[DepthFrame]:
    """The frames within their age limit: neither older, nor so far ahead of the clock, nor without a time.

    Args:
        frames: of any cameras.
        now_ns: the time now [ns, the clock of the frames].
        max_age_ns: the limit [ns]; None: every frame is young enough.
        clock_bounds_ns: as of `Snapshot`; None: of no camera.

    Raises:
        InputError: an age limit without the time now, or one below zero.
    """
    if max_age_ns is None:
        return list(frames)
    bounds = clock_bounds_ns or {}
    if now_ns is None:
        raise InputError("max_age_ns: an age limit needs the time, give now_ns")
    if max_age_ns < 0:
        raise InputError(f"max_age_ns: is {max_age_ns}, must be at least 0")
    return [
        f
        for f in frames
        if f.stamp_ns is not None and abs(now_ns - f.stamp_ns) + bounds.get(f.camera, 0) <= max_age_ns
    ]


def _asked(joints: JointRecord, frame: DepthFrame) -> Positions:
    if frame.stamp_ns is None:
        raise InputError(
            f"frame of {frame.camera}: has no time, so a joint record cannot say where the machine was"
        )
    return joints.at(frame.stamp_ns)
