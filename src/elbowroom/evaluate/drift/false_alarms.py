"""What is no knock and must be called none: furniture that is pushed, people who walk."""

from dataclasses import replace
from typing import Any

import numpy as np

from elbowroom.evaluate.drift.scene import BEFORE, KNOCKED_FRAMES, PERIOD_S, Commissioned, Tell, frames_of
from elbowroom.monitor.health.drift.watch import TURNS
from elbowroom.monitor.health.health import Condition
from elbowroom.sensing import Snapshot
from elbowroom.simulate import Moment, Solid


def furniture_row(scene: Commissioned, tell: Tell) -> dict[str, Any]:
    """Table and patient are pushed by 10 cm: no camera moved, and none may be named."""
    tell(f"table pushed, noise {scene.noise}")
    watch = scene.watch()
    shift = np.eye(4)
    shift[:2, 3] = 0.08, 0.06
    moved: dict[str, Solid] = {}
    for k in range(BEFORE + KNOCKED_FRAMES):
        moment = scene.room.at(80.0 + k * PERIOD_S)
        if k >= BEFORE:
            solids = tuple(_pushed(solid, shift, moved) for solid in moment.solids)
            moment = Moment(moment.time_s, solids, moment.joints)
        health = watch.hear(
            Snapshot.taken(frames_of(scene.cameras, moment, k), moment.joints, moment.stamp_ns)
        )
    return {
        "kind": "furniture",
        "what": "table and patient pushed by 10 cm",
        **scene.words,
        "moments": KNOCKED_FRAMES,
        "cameras_named": len(health.stops),
        "reasons": list(health.stops.values()),
    }


def _pushed(solid: Solid, shift: np.ndarray, moved: dict[str, Solid]) -> Solid:
    if solid.name not in ("table", "patient"):
        return solid
    if solid.name not in moved:
        moved[solid.name] = replace(solid, world_from_solid=shift @ solid.world_from_solid)
    return moved[solid.name]


def false_alarm_row(scene: Commissioned, passes: int, tell: Tell) -> dict[str, Any]:
    """People walk and the machine moves; nothing is knocked.

    A watch listens to every other camera at each pass, in turn, so only those are rendered: each frame is new, is
    listened to, and counts once. After an alarm a new watch goes on.

    Args:
        scene: that was commissioned.
        passes: how many.
        tell: what is being done.
    """
    alarms: list[str] = []
    watch, listened, said_moved, unsure, doubts = scene.watch(), 0, 0, 0, 0
    frames = frames_of(scene.cameras, scene.room.at(400.0), 0)
    for k in range(passes):
        if k % 50 == 0:
            tell(f"false alarms, noise {scene.noise}, pass {k} of {passes}")
        moment = scene.room.at(400.0 + k * PERIOD_S)
        turn = slice(watch.turn, None, TURNS)
        frames[turn] = frames_of(scene.cameras[turn], moment, k)
        health = watch.hear(Snapshot.taken(frames, moment.joints, moment.stamp_ns))
        heard = [camera.condition for camera in health.cameras[turn]]
        listened += len(heard)
        said_moved += sum(condition is Condition.MOVED for condition in heard)
        unsure += sum(condition not in (Condition.MOVED, Condition.STILL) for condition in heard)
        doubts += sum(camera.doubt is not None for camera in health.cameras[turn])
        if health.stops:
            alarms.extend(health.stops.values())
            watch = scene.watch()
    return {
        "kind": "false alarms",
        **scene.words,
        "passes": passes,
        "seconds": passes * PERIOD_S,
        "people": len(scene.room.staff),
        "camera_frames": listened,
        "false_alarms": len(alarms),
        "frames_in_doubt": doubts,
        "reasons": alarms,
        "frames_that_said_moved_pct": 100 * said_moved / listened,
        "frames_that_could_not_tell_pct": 100 * unsure / listened,
    }
