"""Sums of what goes round about a free space: passes of the monitor, merged evidence, reports, settings, placement."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from elbowroom.evaluate.bits.room import COARSE_M, NARROW, TURNED, Shot, images_of, motions_of, room_grid
from elbowroom.evaluate.bits.sums import (
    Row,
    evidence_row,
    report_text,
    row,
    space_row,
    verdict_text,
    verdicts_row,
)
from elbowroom.geometry import DepthCamera
from elbowroom.monitor import Cycle, CycleResult
from elbowroom.motion import blocks_in_reach, check_motions
from elbowroom.placement import FixedRoom, verify
from elbowroom.reconstruct import (
    DETAILS,
    RULES,
    Detail,
    Evidence,
    Rule,
    Terms,
    carve,
    merge,
    reconstruct,
    resolve,
)
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot
from elbowroom.simulate import InterventionRoom, Moment, true_occupancy
from elbowroom.site import Site

NOW_S = 7.0
AGE_NS = 200_000_000
"""Frames older than this are stale [ns]."""
GROUP = 10
"""Of so many cameras is the first of two groups."""
SENSOR_ABOVE_M = 0.6
"""Another sensor measured what is above this height [m]."""
POINTS_M = tuple(product((-1.1, -0.3, 0.05, 0.9), (-0.8, 0.0, 0.7), (0.3, 1.1, 1.9)))
"""Places that are asked about, world frame [m]."""


def cycle_rows() -> Iterator[Row]:
    """Passes of the monitor: whole, with a stale frame, without a camera, with joints over time, with a fault."""
    room = InterventionRoom()
    shot = Shot(NOW_S, noise="tof")
    cameras, frames = images_of(room.at(NOW_S), shot)
    grid = room_grid(COARSE_M)
    # how long a pass takes here makes no difference
    make = partial(Cycle, grid, cameras, room.machine, motions_of(room.machine), clock_ns=lambda: 0)
    terms = Terms(margin=NARROW, max_age_ns=AGE_NS)
    cycles = {
        "": make(terms),
        "unfocused ": make(terms, focused=False),
        "majority ": make(replace(terms, rule="majority", detail="footprint")),
    }
    for name, cycle in cycles.items():
        for what, snapshot in _snapshots(room, shot, frames).items():
            yield from _cycle_rows(cycle.run(snapshot), cycle.terms, name + what)


def _snapshots(room: InterventionRoom, shot: Shot, frames: list[DepthFrame]) -> dict[str, Snapshot]:
    now, before, long_ago = (room.at(NOW_S - back_s) for back_s in (0.0, 0.1, 1.0))
    _, earlier = images_of(before, shot)
    _, stale = images_of(long_ago, shot)
    by_turns = [pair[n % 2] for n, pair in enumerate(zip(frames, earlier, strict=True))]
    given: dict[str, tuple[Sequence[DepthFrame], Mapping[str, float] | JointRecord]] = {
        "whole": (frames, now.joints),
        "stale frame": ([stale[0], *frames[1:]], now.joints),
        "silent camera": (frames[1:], now.joints),
        "no stamp": ([replace(frames[0], stamp_ns=None), *frames[1:]], now.joints),
        "joint record": (by_turns, _record([long_ago, before, now])),
        "fault": (frames, {}),
    }
    return {what: Snapshot.taken(*moment, frames[0].stamp_ns, AGE_NS) for what, moment in given.items()}


def _record(moments: Sequence[Moment]) -> JointRecord:
    names = moments[0].joints
    return JointRecord(
        np.array([moment.stamp_ns for moment in moments]),
        {name: np.array([moment.joints[name] for moment in moments]) for name in names},
    )


def _cycle_rows(result: CycleResult, terms: Terms, what: str) -> Iterator[Row]:
    if result.space is not None:
        yield space_row(result.space, terms.rule, terms.detail, f"{what}: space")
    told = [
        ("verdicts", "\n".join(verdict_text(verdict) for verdict in result.verdicts)),
        ("level", result.level.name),
        ("oldest", result.oldest_age_ms),
        ("fault", result.fault is not None),
    ]
    yield row(f"{what}: verdicts", told, terms.rule, terms.detail)


def merge_rows() -> Iterator[Row]:
    """Evidence of two groups of cameras and another sensor, merged, by every rule; one camera says nothing."""
    room = InterventionRoom()
    moment = room.at(NOW_S, joints=TURNED)
    cameras, frames = images_of(moment, Shot(NOW_S, noise="tof"))
    grid = room_grid(COARSE_M)
    occupied = true_occupancy(grid, moment).occupied
    above = np.zeros(grid.shape, dtype=np.bool_)
    above[:, :, int(SENSOR_ABOVE_M / COARSE_M) :] = True
    other = Evidence.from_mask(grid, "other sensor", above & ~occupied, above & occupied)
    for detail, complete in product(DETAILS, (False, True)):
        asked = partial(carve, grid, detail=detail, margin=NARROW, complete=complete)
        first = asked(cameras[:GROUP], frames[:GROUP])
        second = asked(cameras[GROUP:-1], frames[GROUP:-1])
        words = "counted" if complete else "canonical"
        merged = merge([second, other, first])
        for what, evidence in {"first": first, "second": second, "merged": merged}.items():
            yield evidence_row(evidence, detail, f"{words}: {what}")
        for rule in RULES if complete else RULES[:1]:
            space = resolve(
                merged,
                cameras,
                rule=rule,
                detail=detail,
                margin=NARROW,
                machine=room.machine,
                joints=moment.joints,
            )
            yield space_row(space, rule, detail, f"{words}: space")


def explain_rows() -> Iterator[Row]:
    """What `FreeSpace.explain` says of some points."""
    room = InterventionRoom()
    moment = room.at(NOW_S)
    grid = room_grid(COARSE_M)
    for noise, detail in product((None, "tof"), DETAILS):
        cameras, frames = images_of(moment, Shot(NOW_S, noise=noise))
        space = reconstruct(
            grid, cameras, frames, room.machine, moment.joints, detail=detail, margin=NARROW, looks=False
        )
        reports = [space.explain(point) for point in POINTS_M]
        pieces = [("reports", "\n".join(report_text(report) for report in reports))]
        yield row(f"reports, {noise or 'exact'}", pieces, Terms().rule, detail)


def settings_rows() -> Iterator[Row]:
    """The other arguments of `reconstruct`: age, tolerance, growth of the body, focus, one thread, no machine."""
    room = InterventionRoom()
    moment = room.at(NOW_S)
    cameras, frames = images_of(moment, Shot(NOW_S, noise="tof"))
    grid = room_grid(COARSE_M)
    motions = motions_of(room.machine)
    settings: Mapping[str, Mapping[str, object]] = {
        "one thread": {"threads": 1},
        "too old": {"now_ns": moment.stamp_ns + 2 * AGE_NS, "max_age_ns": AGE_NS},
        "tolerance": {"explain_tolerance_m": 0.03},
        "growth": {"body_growth_m": 0.06},
        "focus": {"focus": blocks_in_reach(grid, room.machine, moment.joints, motions[:2])},
    }
    chosen: tuple[tuple[Rule, Detail], ...] = (("three", "pixel"), ("majority", "footprint"))
    for (name, more), (rule, detail) in product(settings.items(), chosen):
        space = reconstruct(
            grid,
            cameras,
            frames,
            room.machine,
            moment.joints,
            rule=rule,
            detail=detail,
            margin=NARROW,
            **more,  # type: ignore[arg-type]
            looks=False,
        )
        yield space_row(space, rule, detail, f"{name}: space")
        verdicts = check_motions(space, room.machine, moment.joints, motions)
        yield verdicts_row(verdicts, rule, detail, f"{name}: verdicts")
    for rule, detail in chosen:
        bare = reconstruct(grid, cameras, frames, rule=rule, detail=detail, margin=NARROW, looks=False)
        yield space_row(bare, rule, detail, "no machine: space")
        yield space_row(bare.without(room.machine, moment.joints), rule, detail, "without: space")


def placement_rows() -> Iterator[Row]:
    """Views of each voxel of the simulated room without people, and of a box of which nothing is known."""
    grid = room_grid(2 * COARSE_M)
    cameras: Sequence[DepthCamera] = images_of(InterventionRoom().at(0.0), Shot(0.0, size="thesis"))[0]
    for what, room in {"room": FixedRoom.of_site(Site.simulated_room()), "box": None}.items():
        found = verify(grid, cameras, room)
        pieces = [
            ("seen", found.seen),
            ("counts", found.counts),
            ("apart", found.apart),
            ("asked", found.asked),
        ]
        yield row(f"views, {what}", pieces)
