"""Poses a few millimetres beside an object: which motions are refused although they lead away, which go too far?

Space is the truth in voxels: blocked is each voxel that an object touches, within the machine as well. So this asks the
swept check alone, without cameras: once as of a volume that comes from elsewhere, in *voxels*; and once *in parts*,
where of a voxel that the check asks of again those parts are free that nothing touches, as if cameras were asked.
*Leads away*: within S no link comes nearer to anything that is less than a voxel's diagonal away than it stands, and at
S nothing is so near any more that was at the start.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.escape.in_parts import TrueParts
from elbowroom.evaluate.escape.poses import Scene, pose_beside, scenes
from elbowroom.evaluate.rooms.scene import SAME
from elbowroom.motion import Level, Motion, Verdict, check_motions
from elbowroom.reconstruct import FreeSpace

STEPS = 24
"""At so many places along S it is looked how near links are, and along what is announced whether they touch."""
NEARER_M = 1e-4
"""A link that comes nearer by less does not."""
DUE = (
    Due("refused_pct", "≤", 2.0, words="refused although they lead away"),
    Due("beyond", "≤", 0, words="announced beyond the truth"),
    Due("touching", "≤", 0, words="contacts on the announced way"),
)


def escape_rows(poses: int = 300, *, voxel_size_m: float = 0.02, seed: int = 5) -> Iterator[dict[str, Any]]:
    """All motions of poses 0.3 to 20 mm beside an object.

    Args:
        poses: how many, over all scenes in turn.
        voxel_size_m: edge of a voxel [m].
        seed: of places and poses.

    Yields:
        A row of kind "verdict" for each pose, motion and space.

    Raises:
        PackageError: coal is not installed.
        InputError: the examples are not there, as in an installation.
    """
    every = list(scenes(voxel_size_m, seed))
    for n, scene in enumerate(every):
        volume = FreeSpace.from_occupied(scene.grid, scene.occupied)
        spaces = {"voxels": volume, "in parts": replace(volume, source=TrueParts(scene.solids))}
        rng = np.random.default_rng([seed, n])
        for pose in range(n, poses, len(every)):
            joints, gap = pose_beside(scene, rng)
            truths = [_true(scene, joints, motion) for motion in scene.motions]
            for words, space in spaces.items():
                said = {
                    "kind": "verdict",
                    "scene": scene.name,
                    "pose": pose,
                    "space": words,
                    "gap_mm": 1e3 * gap,
                }
                verdicts = check_motions(space, scene.machine, joints, scene.motions)
                for motion, verdict, truth in zip(scene.motions, verdicts, truths, strict=True):
                    yield {**said, **_judged(scene, joints, motion, verdict, truth)}


def _true(scene: Scene, joints: Mapping[str, float], motion: Motion) -> dict[str, Any]:
    contact = scene.truth.until_contact(joints, motion)
    away = not contact.touches and leads_away(scene, joints, motion)
    return {"true_travel": contact.travel, "leads_away": away}


def _judged(
    scene: Scene, joints: Mapping[str, float], motion: Motion, verdict: Verdict, truth: Mapping[str, Any]
) -> dict[str, Any]:
    announced = np.linspace(0.0, verdict.free_travel, STEPS + 2)[1:-1]
    return {
        "joint": motion.joint,
        "direction": "-+"[motion.direction > 0],
        "level": verdict.level.name.lower(),
        "cause": verdict.cause.name.lower(),
        "escapes": verdict.escapes,
        "free_travel": verdict.free_travel,
        **truth,
        "beyond": verdict.free_travel > truth["true_travel"] + SAME,
        "touching": any(_touches(scene, _moved(joints, motion, travel), motion) for travel in announced),
    }


def _touches(scene: Scene, joints: Mapping[str, float], motion: Motion) -> bool:
    """Whether a link that moves touches anything."""
    return any(gap <= 0 for gap in scene.truth.gaps(joints, motion.joint, NEARER_M).values())


def leads_away(scene: Scene, joints: Mapping[str, float], motion: Motion) -> bool:
    """Whether a motion leads away from all that is near.

    Args:
        scene: where.
        joints: from where [m or rad].
        motion: which.
    """
    joint = scene.machine.joint(motion.joint)
    room = joint.upper - joints[joint.name] if motion.direction > 0 else joints[joint.name] - joint.lower
    if room < motion.braking_distance:
        return False
    near_m = np.sqrt(3) * scene.grid.voxel_size_m
    at_start = scene.truth.gaps(joints, joint.name, near_m)
    for travel in np.linspace(0.0, motion.braking_distance, STEPS + 1)[1:]:
        now = scene.truth.gaps(_moved(joints, motion, travel), joint.name, near_m)
        if any(gap < at_start.get(pair, near_m) - NEARER_M for pair, gap in now.items()):
            return False
    return not set(now) & set(at_start)


def _moved(joints: Mapping[str, float], motion: Motion, travel: float) -> dict[str, float]:
    return {**joints, motion.joint: joints[motion.joint] + motion.direction * float(travel)}


def escape_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row of kind "summary" for each space, of it for all and for each machine, of rows of `escape_rows`."""
    sums = []
    for space in dict.fromkeys(row["space"] for row in rows):
        own = [row for row in rows if row["space"] == space]
        machines = dict.fromkeys(row["scene"].split(",")[0] for row in own)
        for machine in ("all", *machines):
            some = [row for row in own if machine in ("all", row["scene"].split(",")[0])]
            sums.append({"kind": "summary", "space": space, **_summed(machine, some)})
    return sums


def _summed(machine: str, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    away = [row for row in rows if row["leads_away"]]
    stop = Level.STOP.name.lower()
    refused = sum(row["level"] == stop for row in away)
    return {
        "machine": machine,
        "poses": len({(row["scene"], row["pose"]) for row in rows}),
        "motions": len(rows),
        "least_gap_mm": min(row["gap_mm"] for row in rows),
        "leads_away": len(away),
        "refused": refused,
        "refused_pct": 100 * refused / max(1, len(away)),
        "escapes": sum(row["escapes"] for row in rows),
        "beyond": sum(row["beyond"] for row in rows),
        "touching": sum(row["touching"] for row in rows),
    }
