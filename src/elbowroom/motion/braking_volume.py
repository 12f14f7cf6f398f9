"""Whether a machine of which position and velocity are known comes to rest in free space if it is told to stop now."""

from collections.abc import Sequence
from dataclasses import replace

from elbowroom.errors import JointsError
from elbowroom.machine import Machine
from elbowroom.motion.braking import Braking
from elbowroom.motion.check import Scene
from elbowroom.motion.course import way_of
from elbowroom.motion.motion import Motion
from elbowroom.motion.path import PathVerdict, path_in
from elbowroom.motion.path_way import PathWay
from elbowroom.motion.speed import STANDS, is_made
from elbowroom.motion.trajectory import MachineState, Trajectory
from elbowroom.motion.verdict import Level, Verdict
from elbowroom.reconstruct.free_space import FreeSpace

FASTER_MEASURED = 0.1
"""A joint may be measured to be faster than its full speed by this share."""


def check_stop(space: FreeSpace, machine: Machine, state: MachineState, braking: Braking) -> PathVerdict:
    """Whether a machine that is told to stop now comes to rest in free space: its braking volume, from where it is.

    Until it brakes each joint goes on as fast as it is. It is `check_path` for a path that ends here, at these speeds.

    Args:
        space, machine, braking: as of `check_path`.
        state: where it is and how fast.

    Returns:
        `is_free` if so; the path's time 0 is now.

    Raises:
        MachineError, JointsError: as `check_path`; a joint that is faster than its full speed by more than a tenth.
    """
    scene = Scene.of(space, machine, machine.positions(state.positions))
    return _stop_in(scene, state, braking)


def check_moving(
    space: FreeSpace, machine: Machine, state: MachineState, motions: Sequence[Motion], braking: Braking
) -> tuple[list[Verdict], PathVerdict]:
    """Motions of a machine that moves, and its stop. Where that is not free, motions that are being made are stop.

    Args:
        space, machine: as of `check_motions`.
        state: where it is and how fast.
        motions: what to check.
        braking: how its joints come to rest.

    Raises:
        MachineError, JointsError: as `check_stop`.
    """
    start = machine.positions(state.positions)
    scene = Scene.of(space, machine, start)
    verdicts = scene.verdicts(motions, [way_of(machine, start, motion) for motion in motions])
    stop = _stop_in(scene, state, braking)
    if not stop.is_free:
        verdicts = [_stopped(v, stop) if is_made(v, state.velocities) else v for v in verdicts]
    return verdicts, stop


def _stop_in(scene: Scene, state: MachineState, braking: Braking) -> PathVerdict:
    path = _coasting(scene.machine, state, braking)
    way = PathWay.of(scene.machine, state.positions, path, braking)
    return path_in(scene, path, way, braking)


def _stopped(verdict: Verdict, stop: PathVerdict) -> Verdict:
    """Stop where it is, for what the machine would meet as it comes to rest; a stop stays what it is."""
    first = stop.first
    if verdict.level is Level.STOP or first is None:
        return verdict
    return replace(
        verdict,
        level=Level.STOP,
        free_travel=0.0,
        link=first.link,
        place_in_world=first.place_in_world,
        cause=first.cause,
        other_link=first.other_link,
        escapes=False,
        zone=first.zone,
    )


def _coasting(machine: Machine, state: MachineState, braking: Braking) -> Trajectory:
    """A path of one point, at the speeds that the machine has.

    Raises:
        JointsError: a joint that is faster than it can be.
    """
    names, speeds = list[str](), list[float]()
    for name in machine.joint_names:
        speed = state.velocities.get(name, 0.0)
        full = braking.speeds.get(name)
        if full is None and abs(speed) < STANDS:
            speed = 0.0  # a joint that nobody commands, and what its encoder says of noise
        if full is not None and abs(speed) > full * (1 + FASTER_MEASURED):
            raise JointsError(
                f"machine's state: joint {name} moves at {speed:g} a second, its full speed is {full:g} [m/s or rad/s]"
            )
        if full is not None and abs(speed) > full:
            speed *= abs(speed) / full  # it brakes for longer, too
        if speed:
            names.append(name)
            speeds.append(speed)
    if not names:
        names, speeds = list(machine.joint_names[:1]), [0.0]
    return Trajectory(names, [0.0], [[state.positions[name] for name in names]], [speeds])
