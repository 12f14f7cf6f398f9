"""Cameras that are turned or pushed far: in doubt at the first image, before any test can be sure."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.drift.scene import BEFORE, KNOCKED_FRAMES, Commissioned, Tell, frames_of
from elbowroom.monitor.health.drift.camera_watch import CameraWatch
from elbowroom.simulate.knock import Knock

STEP_S = 1 / 15
START_S = 900.0
TURN_DEG, MOVE_M = (4.0, 10.0), 0.06
KNOCKS: dict[str, Knock] = {
    **{
        f"turn {size:g} degrees about {axis}": Knock("", tuple(np.radians(size) * np.eye(3)[i]), (0, 0, 0))
        for size in TURN_DEG
        for i, axis in enumerate("xyz")
    },
    **{
        f"move {100 * MOVE_M:g} cm along {axis}": Knock("", (0, 0, 0), tuple(MOVE_M * np.eye(3)[i]))
        for i, axis in enumerate("xyz")
    },
}


def doubt_rows(scene: Commissioned, tell: Tell) -> Iterator[dict[str, Any]]:
    """Each camera is knocked in each way, alone, at 15 images a second, people walking.

    A move that would bring a camera into a wall is left out.

    Args:
        scene: that was commissioned.
        tell: what is being done.

    Yields:
        Rows of `knock`, `runs`, `in_doubt_at_once`, `named` within `KNOCKED_FRAMES`, `undoubted_frames`: images after
        the first one that were neither in doubt nor of a camera that was named.
    """
    for name, knock in KNOCKS.items():
        tell(f"{name}, noise {scene.noise}")
        runs = [run for n in range(len(scene.cameras)) if (run := _run(scene, n, knock)) is not None]
        yield {
            "kind": "doubt",
            "knock": name,
            **scene.words,
            "runs": len(runs),
            "in_doubt_at_once": sum(doubted[0] for doubted, _ in runs),
            "undoubted_frames": sum(not each for doubted, _ in runs for each in doubted[1:]),
            "named": sum(named for _, named in runs),
        }


def _run(scene: Commissioned, number: int, knock: Knock) -> tuple[list[bool], bool] | None:
    """Of one camera, whether each image since the knock was in doubt, until it was named; None: it cannot be there."""
    camera = scene.cameras[number]
    watch, truly = CameraWatch(camera, scene.references[number]), knock.camera(camera)
    doubted: list[bool] = []
    for k in range(BEFORE + KNOCKED_FRAMES):
        moment = scene.room.at(START_S + k * STEP_S)
        try:
            (frame,) = frames_of([camera if k < BEFORE else truly], moment, 7000 + k)
        except InputError:
            return None
        said = watch.hear(frame, moment.stamp_ns)
        if watch.stop is not None:
            doubted += [] if doubted else [True]
            break
        if k >= BEFORE:
            doubted.append(said.doubt is not None)
    return doubted, watch.stop is not None
