"""Contradictions between cameras in words: who contradicts, how much, what it most likely is, what to do."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.outside import looks_out, room_of
from elbowroom.reconstruct.contradiction.pairs import Pairs
from elbowroom.reconstruct.contradiction.scales import scale_findings
from elbowroom.reconstruct.contradiction.suspicion import (
    FEW,
    Share,
    Suspicion,
    explained,
    share_of,
    standing,
)
from elbowroom.reconstruct.contradiction.views import Views
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.masked import masked_returns
from elbowroom.sensing.values.unit import KIND as UNIT

KIND = "contradiction"
LIMIT = 0.2
"""A camera of whose comparisons with others a larger share is contradicted stops everything,"""
COMPARED = 64
"""if so many comparisons were made: fewer are a warning."""
LEAST = 10
"""Fewer contradictions than this are not worth a warning."""
WARNED, BESIDE_OTHERS = 0.1, 8.0
"""A camera is warned of whose share is larger than this, and so many times that of the others among each other."""
USUAL = 40
"""A camera that shares no view with others is told of if of these two agree in so many points."""
OF_DEPTHS = ("lens", "depth unit", "depth kind")
"""Mistakes that are none of poses."""
MANY = 4
"""More cameras than this are counted, not listed."""
SEEN_THROUGH = "one measured a surface and the other sees through it"
CORRECT = "correct them, or calibrate anew (elbowroom calibrate extrinsics)"
SAME_M, SAME_RAD = 1e-3, 1e-3
"""Poses no farther apart than this are one."""


def contradictions(
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    margin: Margin,
    found: Sequence[Finding] = (),
) -> tuple[Finding, ...]:
    """What is found where the images of one moment are compared with each other, and with their masks.

    Args:
        cameras: of the room.
        frames: at most one of each, of its camera's size; cameras without one are left out.
        margin: of cameras without one of their own.
        found: about these cameras; those of which something found stops are not compared. Where that is their unit of
            depth they are, since poses of other axes look like another unit: then a mistake about poses alone is told.
    """
    everybody = [camera.name for camera in cameras]
    stopped = (finding for finding in found if finding.stops and finding.kind != UNIT)
    wrong = {name for finding in stopped for name in finding.about or everybody}
    cameras = [camera for camera in cameras if camera.name not in wrong]
    frames = [frame for frame in frames if frame.camera not in wrong]
    views = Views.of(cameras, frames, margin)
    units = {name for finding in found if finding.stops and finding.kind == UNIT for name in finding.about}
    told = _of_poses(views) if units else found_in(views)
    return (*masked_returns(cameras, frames), *told)


def with_contradictions(
    cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame], margin: Margin, found: Sequence[Finding]
) -> tuple[Finding, ...]:
    """What was found, and what contradicts; a unit of depth that poses explain is left out.

    Args:
        cameras, frames, margin, found: as of `contradictions`.
    """
    contradicting = contradictions(cameras, frames, margin, found)
    named = {name for finding in contradicting if finding.kind == KIND for name in finding.about}
    kept = (
        finding
        for finding in found
        if not (finding.stops and finding.kind == UNIT and named.issuperset(finding.about))
    )
    return (*kept, *contradicting)


def _of_poses(views: Views) -> tuple[Finding, ...]:
    """Mistakes about poses that explain what is seen."""
    if len(views.eyes) < 2 or not standing(views.pairs).suspects:
        return ()
    suspicions, _ = explained(views)
    return tuple(
        _of_mistake(views.eyes, suspicion)
        for suspicion in suspicions
        if suspicion.mistake.kind not in OF_DEPTHS
    )


def found_in(views: Views) -> tuple[Finding, ...]:
    """As `contradictions`; beyond the limit it stops, whatever is found to be the reason.

    Args:
        views: of one moment.
    """
    if len(views.eyes) < 2:
        return ()
    found = _reasons(views)
    beyond = tuple(finding for finding in beyond_limit(views.eyes, views.pairs) if finding.stops)
    if not beyond or any(finding.stops for finding in found):
        return found
    about, named = ({name for finding in these for name in finding.about} for these in (beyond, found))
    has_twin = any(_twin(views.eyes, n) for n, eye in enumerate(views.eyes) if eye.name in named)
    if named and named <= about and not has_twin:
        return tuple(replace(finding, stops=True) for finding in found)
    return (*beyond, *(finding for finding in found if not about.issuperset(finding.about)))


def _reasons(views: Views) -> tuple[Finding, ...]:
    """What is likely, and what has no reason that is known."""
    if not standing(views.pairs).suspects:
        return scale_findings(views)
    suspicions, left = explained(views)
    of_all = any(len(suspicion.cameras) == len(views.eyes) for suspicion in suspicions)
    scales = () if of_all else scale_findings(views, wholly=bool(suspicions))
    if scales and suspicions:
        return scales
    scaled = {name for finding in scales for name in finding.about}
    named = {camera for each in suspicions for camera in each.cameras}
    named |= {number for number, eye in enumerate(views.eyes) if eye.name in scaled}
    return (
        *(_of_mistake(views.eyes, suspicion) for suspicion in suspicions),
        *scales,
        *unexplained(views.eyes, left.pairs, named),
        *_alone(left, named),
    )


def beyond_limit(eyes: Sequence[Eye], pairs: Pairs) -> tuple[Finding, ...]:
    """Cameras that contradict others beyond a limit; nobody looks for the reason.

    Args:
        eyes: how all cameras are said to see.
        pairs: counted between them, at moments near each other.
    """
    return unexplained(eyes, pairs, set())


def unexplained(eyes: Sequence[Eye], pairs: Pairs, named: Collection[int]) -> tuple[Finding, ...]:
    """Cameras that contradict others beyond a limit, whatever the reason.

    Args:
        eyes: how all cameras are said to see.
        pairs: counted between them.
        named: cameras that something was found about already.
    """
    now = standing(pairs)
    worst = [
        (camera, share)
        for camera, share in zip(now.contradicting, now.shares, strict=True)
        if camera not in named and _is_told(share, _others(pairs, camera))
    ]
    if 2 * len(worst) > len(eyes) or len(eyes) == 2:
        return _of_all(eyes, worst)
    return tuple(_of_one(eyes, camera, share, _others(pairs, camera)) for camera, share in worst)


def _others(pairs: Pairs, camera: int) -> Share:
    """What all but one camera compare among each other."""
    rest = [other for other in range(len(pairs.through)) if other != camera]
    return share_of(pairs, rest, rest)


def _is_told(share: Share, others: Share) -> bool:
    is_beside = share.value > max(WARNED, BESIDE_OTHERS * others.value)
    return share.through >= LEAST and (_stops(share) or is_beside)


def _of_mistake(eyes: Sequence[Eye], suspicion: Suspicion) -> Finding:
    """A mistake that explains what is seen."""
    mistake, before, after = suspicion.mistake, suspicion.before, suspicion.after
    names = tuple(eyes[camera].name for camera in suspicion.cameras)
    if before.compared >= FEW and before.through:
        instead = f"{_percent(after)} contradict instead of {_percent(before)}"
    else:
        instead = f"{after.agrees} points agree with other cameras instead of {before.agrees}"
    text = f"{_listed(names, len(eyes))}: {mistake.looks}: with {mistake.cure} {instead}; {mistake.advice}"
    return Finding(KIND, names, text, True)


def _of_one(eyes: Sequence[Eye], camera: int, share: Share, others: Share) -> Finding:
    name = eyes[camera].name
    twin = _twin(eyes, camera)
    likely = (
        f"it has the pose of {twin}, one of them is wrong"
        if twin
        else "pose, lens or unit of depth are not what the site says, or the images are of another camera"
    )
    text = (
        f"{name}: {_percent(share)} of {share.compared} comparisons with other cameras contradict, {SEEN_THROUGH} "
        f"(the others among each other: {_percent(others)}); {likely}: {CORRECT}"
    )
    return Finding(KIND, (name,), text, _stops(share) or twin is not None)


def _alone(views: Views, named: Collection[int]) -> tuple[Finding, ...]:
    """Cameras that share no view with others, where these share theirs, and look out of the room that these see."""
    now = standing(views.pairs)
    if len(now.core) < 2 or now.usual < USUAL:
        return ()
    why = (
        f"shares no view with the other cameras, of which two agree in {now.usual:.0f} points, and measures places "
        "outside of all that they see; if it looks into the same room, pose or lens are not what the site says"
    )
    room = room_of(views, now.core)
    alone = (
        n
        for n in now.lonely
        if n not in named and len(views.samples[n].u) >= COMPARED and looks_out(views, n, room)
    )
    names = (views.eyes[camera].name for camera in alone)
    return tuple(Finding(KIND, (name,), f"{name}: {why}", False) for name in names)


def _of_all(eyes: Sequence[Eye], worst: Sequence[tuple[int, Share]]) -> tuple[Finding, ...]:
    if not worst:
        return ()
    everybody = tuple(eye.name for eye in eyes)
    most = max((share for _, share in worst), key=lambda share: share.value)
    text = (
        f"{_listed(everybody, len(eyes))}: contradict each other, up to {_percent(most)} of {most.compared} "
        f"comparisons, {SEEN_THROUGH}; poses, lenses or units of depth are not what the site says: {CORRECT}"
    )
    return (Finding(KIND, everybody, text, any(_stops(share) for _, share in worst)),)


def _stops(share: Share) -> bool:
    return share.value > LIMIT and share.compared >= COMPARED


def _twin(eyes: Sequence[Eye], camera: int) -> str | None:
    """Who is said to stand in the same place and look the same way."""
    own = eyes[camera]
    for number, other in enumerate(eyes):
        same_place = np.abs(other.centre - own.centre).max() < SAME_M
        if number != camera and same_place and np.abs(other.axes - own.axes).max() < SAME_RAD:
            return other.name
    return None


def _listed(names: Sequence[str], cameras: int) -> str:
    if len(names) == cameras and cameras > 2:
        return f"all {cameras} cameras"
    if len(names) > MANY:
        return f"{len(names)} of {cameras} cameras ({', '.join(names[:MANY])} and others)"
    return " and ".join(names) if len(names) < 3 else ", ".join(names)


def _percent(share: Share) -> str:
    return f"{100 * share.value:.1f} %"
