"""What would change it, as values: which camera would see the place if what moved by how much, and what else helps."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from elbowroom.monitor.why.hiding import Hiding, hiding_of
from elbowroom.monitor.why.why import Why, near_enough_m
from elbowroom.motion import Cause, Verdict
from elbowroom.reconstruct import FreeSpace
from elbowroom.reconstruct.point_report import Sight
from elbowroom.reconstruct.source import ImageSource

MOST_CAMERAS = 2
"""So many cameras are named: those that need the least."""


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that would change a verdict.

    Args:
        kind: its name; the page's words have a phrase for each.
        values: what the phrase says; lengths in metres, travel in the motion's unit.
    """

    kind: str
    values: Mapping[str, str | float] = field(default_factory=dict)


def changes_of(found: Why, space: FreeSpace) -> tuple[Change, ...]:
    """What would change a verdict, that which needs least first.

    Args:
        found: why it ends where it does.
        space: that it was checked in.
    """
    verdict, source = found.verdict, space.source
    if found.report is None or not isinstance(source, ImageSource):
        return tuple(_by_word(verdict))
    named = (Cause.KEPT_OUT, Cause.MACHINE, Cause.OUTSIDE_GRID, Cause.NONE)
    if verdict.cause in named:
        return tuple(_by_word(verdict))
    if verdict.cause is Cause.SURFACE and found.measuring:
        return (*_of_surface(found, source), *_override(verdict))
    return (*_of_sight(found, source, space.grid.voxel_size_m), *_override(verdict))


def _by_word(verdict: Verdict) -> Iterator[Change]:
    """Where no image is asked."""
    link = verdict.link or ""
    if verdict.cause is Cause.OUTSIDE_GRID:
        yield Change("box", {"link": link})
    if verdict.cause is Cause.MACHINE:
        yield Change("back")
        yield Change("touch", {"link": link, "other": verdict.other_link or ""})
    if verdict.cause is Cause.KEPT_OUT:
        yield Change("zone", {"zone": verdict.zone or ""})
    if verdict.cause is Cause.SURFACE:
        yield Change("is_there")
    if verdict.cause in (Cause.UNSEEN, Cause.BLIND):
        yield Change("other_side")
    yield from _override(verdict)


def _of_surface(found: Why, source: ImageSource) -> Iterator[Change]:
    """Something was measured there: it lies within the margin, or it is in the way."""
    link = found.verdict.link or ""
    if not found.is_the_margin or found.outside_m is None:
        if found.outside_m is None:
            yield Change("is_there")
        else:
            yield Change("something", {"distance_m": found.outside_m, "link": link})
        return
    widest = max(found.measuring, key=lambda camera: camera.margin_m)
    names = ", ".join(camera.camera for camera in found.measuring)
    yield Change(
        "margin",
        {"distance_m": found.outside_m, "margin_m": widest.margin_m, "link": link, "cameras": names},
    )
    camera = next(one for one in source.images.cameras if one.name == widest.camera)
    nearer = near_enough_m(camera, found.outside_m, source)
    if nearer is not None:
        yield Change("nearer", {"distance_m": nearer, "camera": widest.camera, "now_m": widest.distance_m})


def _of_sight(found: Why, source: ImageSource, edge_m: float) -> Iterator[Change]:
    """Nobody could say that the place is free: who would, and if what."""
    report = found.report
    assert report is not None
    hidden = [one for one in report.cameras if one.sight in (Sight.HIDDEN, Sight.EDGE)]
    hiding = [hiding_of(source, one, report.centre_m, edge_m) for one in hidden]
    told = sorted((one for one in hiding if one is not None), key=_effort)
    for camera in report.cameras:
        if camera.sight is Sight.AGED:
            yield Change("aged", {"camera": camera.camera})
        if camera.sight is Sight.BLIND:
            yield Change("blind", {"camera": camera.camera, "share": camera.without_return})
    for one in told[:MOST_CAMERAS]:
        yield _moved(one)
    yield Change("other_side")


def _effort(hiding: Hiding) -> tuple[bool, bool, float]:
    """What moves least comes first; what nobody can tell, and the machine, last."""
    return hiding.is_machine, hiding.side is None, hiding.shift_m


def _moved(hiding: Hiding) -> Change:
    values: dict[str, str | float] = {"camera": hiding.camera, "distance_m": hiding.distance_m}
    if hiding.is_machine:
        return Change("machine_hides", values)
    if hiding.side is None:
        return Change("gone", values)
    return Change("move", {**values, "shift_m": hiding.shift_m, "side": hiding.side})


def _override(verdict: Verdict) -> Iterator[Change]:
    """Whether an operator may creep on."""
    creep = verdict.creep
    if not verdict.overridable:
        yield Change("no_override")
    elif creep is not None and creep.travel > 0:
        unit = verdict.free_travel_unit
        yield Change("override", {"travel": creep.travel, "speed": creep.speed, "unit": unit})
    elif creep is not None:
        yield Change("no_creep")
