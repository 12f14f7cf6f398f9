"""Cameras that are knocked: named within two seconds, and no other."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from elbowroom.evaluate.drift.scene import (
    BEFORE,
    KNOCKED_FRAMES,
    PERIOD_S,
    Commissioned,
    Tell,
    frames_of,
    joints_of,
)
from elbowroom.monitor.health.drift.shift import Shift
from elbowroom.monitor.health.drift.shown_part import ShownPart
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.simulate import render
from elbowroom.simulate.knock import Knock

START_S = 50.0
"""The time of the room at which its watch begins."""
EVERY = 3
"""One camera in so many is knocked where several are at once."""
KNOCKS: dict[str, Knock] = {
    **{
        f"turn 1 degree about {a}": Knock("", tuple(np.radians(np.eye(3)[i])), (0, 0, 0))
        for i, a in enumerate("xyz")
    },
    **{f"move 2 cm along {a}": Knock("", (0, 0, 0), tuple(0.02 * np.eye(3)[i])) for i, a in enumerate("xyz")},
}


def knock_rows(scene: Commissioned, tell: Tell) -> Iterator[dict[str, Any]]:
    """Each camera is knocked in each way, alone, while all others stay; and several at once.

    Yields:
        Rows of `knock`, `runs`, `named` (that camera, within 60 frames), `others_named`, `frames_median`, `frames_max`,
        `true` and `said_median` [deg or mm], `error_p95`, `inside_2_sigma_pct` of those whose view shows the whole
        knock; `named_by_a_part`, whose view shows a part of it, and what was said of that; `not_named`.
    """
    still = [
        frames_of(scene.cameras, scene.room.at(START_S + k * PERIOD_S), k)
        for k in range(BEFORE + KNOCKED_FRAMES)
    ]
    for name, knock in KNOCKS.items():
        tell(f"{name}, noise {scene.noise}")
        yield _knock_row(
            scene, name, knock, [_run(scene, still, n, knock) for n in range(len(scene.cameras))]
        )
    yield several_row(scene, still)


class _Run(NamedTuple):
    """One camera knocked: what was said of it, after how many frames, and how many others were named."""

    camera: str
    shift: Shift | None
    frames: int
    others: int


def _run(scene: Commissioned, still: Sequence[Sequence[DepthFrame]], number: int, knock: Knock) -> _Run:
    watch, camera = scene.watch(), scene.cameras[number]
    truly = knock.camera(camera)
    for k, joints in enumerate(joints_of(scene, START_S, len(still))):
        now = list(still[k])
        if k >= BEFORE:
            now[number] = frames_of([truly], scene.room.at(START_S + k * PERIOD_S), 5000 + k)[0]
        health = watch.hear(Snapshot.taken(now, joints, now[0].stamp_ns))
        if camera.name in health.stops:
            break
    others = len(set(health.stops) - {camera.name})
    return _Run(camera.name, watch.shift_of(camera.name), k + 1 - BEFORE, others)


def _knock_row(scene: Commissioned, name: str, knock: Knock, runs: Sequence[_Run]) -> dict[str, Any]:
    turns = any(knock.turn_rad)
    true = 1.0 if turns else 20.0
    named = [(run, run.shift) for run in runs if run.shift is not None]
    whole = [shift for _, shift in named if not shift.not_shown or turns]
    said = np.array([shift.turn_deg if turns else shift.move_mm for shift in whole])
    sigmas = np.array([shift.turn_sigma_deg if turns else shift.move_sigma_mm for shift in whole])
    errors, frames = np.abs(said - true), [run.frames for run, _ in named]
    return {
        "kind": "knock",
        "knock": name,
        **scene.words,
        "runs": len(runs),
        "named": len(named),
        "others_named": sum(run.others for run in runs),
        "frames_median": float(np.median(frames)) if frames else None,
        "frames_max": max(frames, default=None),
        "unit": "deg" if turns else "mm",
        "true": true,
        "said_median": float(np.median(said)) if len(said) else None,
        "error_p95": float(np.percentile(errors, 95)) if len(said) else None,
        "inside_2_sigma_pct": float(100 * np.mean(errors <= 2 * sigmas)) if len(said) else None,
        "named_by_a_part": {
            run.camera: f"{shift.move_mm:.1f} mm" for run, shift in named if shift.not_shown and not turns
        },
        "not_named": [run.camera for run in runs if run.shift is None],
    }


def several_row(scene: Commissioned, still: Sequence[Sequence[DepthFrame]]) -> dict[str, Any]:
    """Every third camera turns by a degree about its y axis at once."""
    knock = KNOCKS["turn 1 degree about y"]
    knocked = {camera.name for camera in scene.cameras[::EVERY]}
    watch = scene.watch()
    for k, joints in enumerate(joints_of(scene, START_S, len(still))):
        moment = scene.room.at(START_S + k * PERIOD_S)
        now = [
            frames_of([knock.camera(camera)], moment, 5000 + k)[0]
            if camera.name in knocked and k >= BEFORE
            else frame
            for camera, frame in zip(scene.cameras, still[k], strict=True)
        ]
        health = watch.hear(Snapshot.taken(now, joints, moment.stamp_ns))
        if knocked <= set(health.stops):
            break
    return {
        "kind": "knock",
        "knock": f"{len(knocked)} cameras at once, turn 1 degree about y",
        **scene.words,
        "runs": len(knocked),
        "named": len(knocked & set(health.stops)),
        "others_named": len(set(health.stops) - knocked),
        "frames_max": k + 1 - BEFORE,
    }


def not_shown_rows(scene: Commissioned) -> Iterator[dict[str, Any]]:
    """Moves of 2 cm that no image shows: of cameras that see too little, along what their references do not show.

    Yields:
        Rows of `camera`, `not_shown`, `turn_deg` and `move_mm` of the motion, and by how much exact images of it differ
        from those before: `differs_mm`, at 99 % of the pixels less, and `differs_sigmas`, its root of the mean square
        over the sensor's noise.
    """
    tolerance = Tolerance()
    for camera, reference in zip(scene.cameras, scene.references, strict=True):
        part = ShownPart.of(reference, tolerance)
        if part is None:
            continue
        motion = np.linalg.pinv(part.across)[:, -1]
        motion *= 0.02 / np.linalg.norm(motion[3:])
        knock = Knock("", tuple(motion[:3]), tuple(motion[3:]))
        moment = scene.room.at(START_S)
        before, after = (
            render([truly], moment, noise=False)[0].depth_m for truly in (camera, knock.camera(camera))
        )
        both = (before > 0) & (after > 0)
        off = np.abs(after - before)[both].astype(float)
        sigma = camera.noise.sigma(before[both]) if camera.noise is not None else np.full(off.shape, np.nan)
        yield {
            "kind": "not shown",
            **scene.words,
            "camera": camera.name,
            "not_shown": ", ".join(part.names),
            "turn_deg": float(np.degrees(np.linalg.norm(motion[:3]))),
            "move_mm": 20.0,
            "differs_mm": float(1e3 * np.percentile(off, 99)),
            "differs_sigmas": float(np.sqrt(np.mean((off / sigma) ** 2))),
        }
