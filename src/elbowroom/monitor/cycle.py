"""One pass: a snapshot in, a verdict for each motion out. Whatever goes wrong on the way is a stop."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from elbowroom.errors import ElbowroomError, InputError, JointsError, MachineError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.stages import raise_interrupt, timed
from elbowroom.motion import (
    Braking,
    Cause,
    Distances,
    JointPath,
    Level,
    MachineState,
    Motion,
    Override,
    PathVerdict,
    Trajectory,
    Verdict,
    asked_of,
    blocks_in_reach,
    check_motions,
    check_moving,
    check_rest,
    link_distances,
    rest_of,
    with_creep,
    with_path,
)
from elbowroom.motion.meant import Rest
from elbowroom.reconstruct import FreeSpace, Terms, free_space_of
from elbowroom.sensing import Snapshot


class Meant(NamedTuple):
    """What a path leaves of verdicts.

    Fields:
        verdicts: no milder than before.
        path, off_path: as of `CycleResult`.
    """

    verdicts: Sequence[Verdict]
    path: PathVerdict | None = None
    off_path: str | None = None


@dataclass(slots=True, eq=False)
class Cycle:
    """The pass and all that stays the same from one to the next. It remembers nothing but its number.

    Args:
        grid: the watched box.
        cameras: all cameras of the room, also those that may deliver nothing.
        machine: what moves.
        motions: what is asked in each pass; at least one.
        terms: how strictly space is judged.
        focused: only the space where the motions can go is looked at, all other space stays unseen.
        keeps_images: results keep the images that their free space was made of, so that it can be explained.
        override: how fast an operator may creep where nobody sees; None: of no stop it is said.
        clock_ns: by which the time that a pass takes is told [ns]; it never goes back.
        look_m: how far from the machine distances are asked, and so looked, in each pass [m]; None: they are not.
        braking: how the machine comes to rest; then, where a snapshot says how fast all of its joints are that have a
            speed, a stop that is not free makes motions that are being made stop. None: that is not asked.

    Raises:
        InputError: no motions, since then nothing would ever say stop.
    """

    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    machine: Machine
    motions: Sequence[Motion]
    terms: Terms = field(default_factory=Terms)
    focused: bool = True
    keeps_images: bool = False
    clock_ns: Callable[[], int] = time.perf_counter_ns
    override: Override | None = None
    look_m: float | None = None
    braking: Braking | None = None
    sequence: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.motions = tuple(self.motions)
        if not self.motions:
            raise InputError("cycle: no motions to check, at least one is needed")

    def run(self, snapshot: Snapshot, begun_ns: int | None = None) -> CycleResult:
        """Judges all motions, from where the joints are now, by the newest frames.

        It does not raise: a fault of any kind is a stop for every motion, with the reason beside it. So is a pass at
        whose end a frame that it used is past its age, and one that took longer than `Terms.pass_ns`.

        Args:
            snapshot: what came.
            begun_ns: when it came [ns of `clock_ns`]; None: now.
        """
        begun_ns = self.clock_ns() if begun_ns is None else begun_ns
        stage_ms: dict[str, float] = {}
        try:
            oldest_ms = snapshot.oldest_age_ms
            space = self._space_of(snapshot, stage_ms)
            with timed("motion", stage_ms):
                checked, stopping = self._checked(space, snapshot)
            meant = self._meant(space, snapshot, checked, stage_ms)
            given = _usable(meant.verdicts)
            distances = self._distances(space, snapshot, stage_ms)
            late = self._late(snapshot, begun_ns)
        except Exception as error:  # at this border a fault becomes a decision: stop
            raise_interrupt(error)
            return self.failed(error, snapshot, stage_ms)
        if late is not None:
            given = {motion: self._stop(motion, Cause.STALE) for motion in self.motions}
        missing = [motion.name for motion in self.motions if motion not in given]
        fault = f"no usable verdict for {', '.join(missing)}" if missing else None
        verdicts = tuple(given.get(motion) or self._stop(motion) for motion in self.motions)
        kept = space if self.keeps_images else space.released()
        result = CycleResult(self._number(), snapshot.now_ns or 0, kept, verdicts, stage_ms, oldest_ms, fault)
        result = replace(result, given=cameras_of(snapshot))
        skew_ms = snapshot.fresh(self.terms.max_age_ns).skew_ms
        return replace(
            result,
            late=late,
            skew_ms=skew_ms,
            distances=distances,
            stopping=stopping,
            velocities=snapshot.velocities or None,
            path=meant.path,
            off_path=meant.off_path,
        )

    def failed(
        self, error: Exception, snapshot: Snapshot | None, stage_ms: dict[str, float] | None = None
    ) -> CycleResult:
        """A pass that came to nothing: stop for every motion.

        Args:
            error: what was raised.
            snapshot: what the pass was about; None: nothing had come.
            stage_ms: time that each stage took [ms], as far as it came.
        """
        verdicts = tuple(self._stop(motion) for motion in self.motions)
        return failure(self._number(), error, snapshot, stage_ms, verdicts)

    def unplaced(self, snapshot: Snapshot) -> CycleResult:
        """A pass in which nobody knows where the machine is: stop for every motion, by what came in."""
        verdicts = tuple(self._stop(motion, Cause.INPUT) for motion in self.motions)
        return CycleResult(self._number(), snapshot.now_ns or 0, None, verdicts, {}, snapshot.oldest_age_ms)

    def _late(self, snapshot: Snapshot, begun_ns: int) -> str | None:
        """What is said where a frame that was used has come of age since its pass began."""
        return lateness(snapshot, self.terms, (self.clock_ns() - begun_ns) / 1e6)

    def _space_of(self, snapshot: Snapshot, stage_ms: dict[str, float]) -> FreeSpace:
        reach = None
        if self.focused:
            joints, around_m = snapshot.joints or {}, self.look_m or 0.0
            motions: tuple[Motion | JointPath, ...] = (*self.motions, *self._path_asked(snapshot))
            reach = blocks_in_reach(self.grid, self.machine, joints, motions, around_m)
        return free_space_of(
            self.grid,
            self.cameras,
            snapshot,
            self.machine,
            self.terms,
            focus=reach,
            timer=lambda stage: timed(stage, stage_ms),
        )

    def _checked(self, space: FreeSpace, snapshot: Snapshot) -> tuple[Sequence[Verdict], PathVerdict | None]:
        """The verdicts, and whether the machine's stop is free where it is known how fast it moves."""
        joints, stopping, speeds = snapshot.joints or {}, None, self._speeds(snapshot.velocities)
        if self.braking is None or speeds is None:
            verdicts = check_motions(space, self.machine, joints, self.motions)
        else:
            state = MachineState(joints, speeds)
            verdicts, stopping = check_moving(space, self.machine, state, self.motions, self.braking)
        if self.override is None:
            return verdicts, stopping
        return with_creep(space, self.machine, joints, verdicts, self.override), stopping

    def _rest(self, snapshot: Snapshot) -> Rest | None:
        """What is left of the path that the machine means to take; None: none is said, or it is over.

        Raises:
            JointsError: it is no path of this machine.
        """
        at_ns = snapshot.moment_ns if snapshot.joints_ns is None else snapshot.joints_ns
        if snapshot.path is None or at_ns is None:
            return None
        if self.braking is None:
            raise JointsError("path: it is not known how the machine comes to rest")
        meant = snapshot.path
        times_s = (meant.stamps_ns - at_ns) / 1e9
        whole = Trajectory(meant.joint_names, times_s, meant.positions, meant.velocities)
        return rest_of(whole, snapshot.joints or {})

    def _path_asked(self, snapshot: Snapshot) -> tuple[JointPath, ...]:
        """The path as a motion, so that space is looked at where it leads; what is wrong with it is said later."""
        with suppress(ElbowroomError):
            rest = self._rest(snapshot)
            if rest is not None and self.braking is not None:
                return (asked_of(self.machine, snapshot.joints or {}, rest, self.braking),)
        return ()

    def _meant(
        self, space: FreeSpace, snapshot: Snapshot, verdicts: Sequence[Verdict], stage_ms: dict[str, float]
    ) -> Meant:
        """What is left of the verdicts by the path that the machine means to take."""
        if snapshot.path is None:
            return Meant(verdicts)
        with timed("path", stage_ms):
            try:
                rest = self._rest(snapshot)
                if rest is None or self.braking is None:
                    return Meant(verdicts)
                path = check_rest(space, self.machine, snapshot.joints or {}, rest, self.braking)
            except (JointsError, MachineError) as error:
                stops = [self._stop(motion, Cause.OFF_PATH) for motion in self.motions]
                return Meant(stops, None, str(error))
        return Meant(with_path(verdicts, path, rest), path)

    def _speeds(self, velocities: Mapping[str, float]) -> Mapping[str, float] | None:
        """Of the joints that have a speed; None: of one of them it is not known."""
        names = () if self.braking is None else self.braking.speeds
        if not names or not all(name in velocities for name in names):
            return None
        return {name: velocities[name] for name in names}

    def _distances(
        self, space: FreeSpace, snapshot: Snapshot, stage_ms: dict[str, float]
    ) -> Distances | None:
        """How far the links are from what is blocked, if anybody asks."""
        if self.look_m is None:
            return None
        with timed("distances", stage_ms):
            return link_distances(space, self.machine, snapshot.joints or {}, self.look_m)

    def _number(self) -> int:
        self.sequence += 1
        return self.sequence - 1

    def _stop(self, motion: Motion, cause: Cause = Cause.FAULT) -> Verdict:
        units = {joint.name: joint.unit for joint in self.machine.joints}
        return Verdict.stop(motion, units.get(motion.joint, "m or rad"), cause)


def failure(
    sequence: int,
    error: Exception,
    snapshot: Snapshot | None,
    stage_ms: dict[str, float] | None,
    verdicts: tuple[Verdict, ...] = (),
) -> CycleResult:
    """What a pass came to that failed; it does not raise, whatever the snapshot is.

    Args:
        sequence: number of the pass.
        error: what was raised.
        snapshot: what the pass was about; None: nothing had come.
        stage_ms: time that each stage took [ms], as far as it came; None: none was begun.
        verdicts: stop for every motion that was asked.
    """
    try:
        now_ns, oldest_ms = (snapshot.now_ns or 0, snapshot.oldest_age_ms) if snapshot else (0, None)
        given = cameras_of(snapshot) if snapshot else None
    except Exception:  # what failed may be the snapshot itself
        now_ns, oldest_ms, given = 0, None, None
    fault = f"{type(error).__name__}: {error}"
    return CycleResult(sequence, now_ns, None, verdicts, stage_ms or {}, oldest_ms, fault, given=given)


def cameras_of(snapshot: Snapshot) -> tuple[str, ...]:
    """Names of the cameras that a snapshot has frames of."""
    return tuple(frame.camera for frame in snapshot.frames)


def lateness(snapshot: Snapshot, terms: Terms, took_ms: float) -> str | None:
    """What is said where a frame that was used has come of age since its pass began, or the pass took longer than was
    assumed to; None: neither.

    Args:
        snapshot: of the pass.
        terms: by which it was judged.
        took_ms: how long the pass took [ms].
    """
    if terms.pass_ns and took_ms > terms.pass_ns / 1e6:
        return f"the pass took {took_ms:.0f} ms, and space was judged for {terms.pass_ns / 1e6:g} ms (pass_time_ms)"
    limit_ns = terms.max_age_ns
    if limit_ns is None:
        return None
    age_ms = snapshot.fresh(limit_ns).oldest_age_ms
    if age_ms is None or age_ms + took_ms <= limit_ns / 1e6:
        return None
    return (
        f"the oldest image is {age_ms + took_ms:.0f} ms old when the verdicts are out, at most "
        f"{limit_ns / 1e6:g} ms are allowed (max_frame_age_ms); the pass took {took_ms:.0f} ms"
    )


def _usable(verdicts: Sequence[Verdict]) -> dict[Motion, Verdict]:
    """By motion, the verdicts that say a level and a distance that is a number of at least zero."""
    return {
        verdict.motion: verdict
        for verdict in verdicts
        if isinstance(verdict, Verdict)
        and isinstance(verdict.motion, Motion)
        and isinstance(verdict.level, Level)
        and np.isfinite(verdict.free_travel)
        and verdict.free_travel >= 0
    }
