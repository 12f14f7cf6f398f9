"""The start of a run: all that it needs is made, and compiled by doing it once."""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import replace

from elbowroom.errors import InputError
from elbowroom.geometry import bits
from elbowroom.machine import Machine
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.health.clocks import Clocks
from elbowroom.monitor.loop import Loop
from elbowroom.monitor.separation.separating import Separating
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.monitor.start.looking import first_looks_of, looks_of, streams_of
from elbowroom.monitor.start.watching import checks_of
from elbowroom.motion import check_motions
from elbowroom.reconstruct import FreeSpace
from elbowroom.sources import Played, Recorded, Room, times_of
from elbowroom.sources.pace import Pace
from elbowroom.sources.times.meeting import gap_ns


def started(room: Room, begin: Callable[[str], None]) -> Loop:
    """A loop over a room, ready to run; a recording comes no faster than it was recorded.

    Args:
        room: without a machine, or without speeds, its free space is seen and no motion is judged.
        begin: told what is being done.

    Raises:
        InputError: the first cycle failed, so that all would.
        SiteError, CalibrationError: as `checks_of`.
    """
    separating = None if room.unasked is not None else Separating.of(room)
    cycle = _cycle(room, separating)
    waits, recorded = isinstance(room.source, Recorded), isinstance(room.source, Recorded | Played)
    pause_ns = _gap_ns(room) if recorded else gap_ns(None)
    with ThreadPoolExecutor(1) as aside:
        # what is loaded for motions is loaded while cameras are commissioned
        blocked = aside.submit(copy_context().run, _judge_blocked, cycle)
        checks = replace(checks_of(room, begin), looks=looks_of(room), first=first_looks_of(room))
        blocked.result()
    pace = Pace(pause_ns).early_s if waits else None
    loop = Loop(room, checks, cycle, pace, separating=separating)
    _warm_up(loop, begin)
    # after that, since the source begins anew, and its times with it
    clocks = Clocks(room.terms.max_age_ns, recorded, pause_ns)
    streams = streams_of(room, () if checks.watch is None else checks.watch.references)
    return replace(loop, checks=replace(checks, first=(*checks.first, clocks), streams=streams))


def _gap_ns(room: Room) -> int:
    """How long nothing has to come in a recording to be a gap [ns]."""
    times = times_of(room.site)
    return gap_ns(None) if times is None else times.gap_ns


def _cycle(room: Room, separating: Separating | None) -> Cycle | SpaceCycle:
    if separating is None:
        return SpaceCycle(room.grid, room.cameras, room.machine, room.terms)
    machine, motions = room.machine_and_motions()
    return Cycle(
        room.grid,
        room.cameras,
        machine,
        motions,
        room.terms,
        override=room.site.override(machine),
        braking=room.site.braking(machine),
        look_m=separating.figures.look_m,
    )


def _warm_up(loop: Loop, begin: Callable[[str], None]) -> None:
    """Compiles all that the loop uses, by doing it once; also where something is in the way."""
    cycle = loop.cycle
    begin("first frames")
    snapshot = next(iter(loop.room.source), None)
    if snapshot is None:
        return
    if isinstance(cycle, Cycle):
        loop.room.placed(snapshot)
    begin("first cycle")
    if isinstance(cycle, Cycle) and snapshot.joints is None:
        # joints come later: the pass is made as if they had, and whoever watches the machine is not told of it
        result = cycle.run(replace(snapshot, joints=_mid_pose(cycle.machine)))
    else:
        result = loop.judge(snapshot)
    if result.fault is not None:
        raise InputError(f"the first cycle failed: {result.fault}")


def _judge_blocked(cycle: Cycle | SpaceCycle) -> None:
    """Judges motions once where nothing is free, as no pass may do for long: it compiles what looks at what blocks."""
    if isinstance(cycle, Cycle):
        nothing = bits.empty(cycle.grid)
        all_blocked = FreeSpace(cycle.grid, nothing, nothing, nothing, nothing)
        check_motions(all_blocked, cycle.machine, _mid_pose(cycle.machine), cycle.motions)


def _mid_pose(machine: Machine) -> dict[str, float]:
    """All joints in the middle of their limits, those without two of them as near to zero as may be [m or rad]."""
    joints = [machine.joint(name) for name in machine.joint_names]
    middles = {joint.name: (joint.lower + joint.upper) / 2 for joint in joints}
    near = machine.nearest_to_zero()
    return {name: middle if math.isfinite(middle) else near[name] for name, middle in middles.items()}
