"""Joints that say what is not true: the machine is named, and no camera."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from elbowroom.evaluate.drift.scene import BEFORE, KNOCKED_FRAMES, PERIOD_S, Commissioned, Tell, frames_of
from elbowroom.monitor.health.drift.watch import BODY
from elbowroom.sensing import Snapshot

WRONG_JOINTS: dict[str, tuple[float, ...]] = {
    "long": (0.03,),
    "larm": (float(np.radians(2.0)),),
    "propeller": (float(np.radians(-3.0)),),
    "carc": (float(np.radians(3.0)),),
}
"""Joint and what it says too much [m or rad]."""


def joint_rows(scene: Commissioned, tell: Tell) -> Iterator[dict[str, Any]]:
    """A joint says more than is true; all cameras stand still.

    Yields:
        Rows of `joint`, `wrong_by` [m or rad], `found`, `frames`, `reason`, `cameras_named`.
    """
    for joint, amounts in WRONG_JOINTS.items():
        for amount in amounts:
            tell(f"{joint} wrong, noise {scene.noise}")
            watch = scene.watch()
            for k in range(BEFORE + KNOCKED_FRAMES):
                moment = scene.room.at(30.0 + k * PERIOD_S)
                joints = dict(moment.joints)
                joints[joint] += amount if k >= BEFORE else 0.0
                health = watch.hear(
                    Snapshot.taken(frames_of(scene.cameras, moment, k), joints, moment.stamp_ns)
                )
                if health.stops:
                    break
            yield {
                "kind": "wrong joint",
                "joint": joint,
                "wrong_by": amount,
                **scene.words,
                "found": BODY in health.stops,
                "frames": k + 1 - BEFORE if health.stops else None,
                "reason": health.stops.get(BODY),
                "cameras_named": len(set(health.stops) - {BODY}),
            }
