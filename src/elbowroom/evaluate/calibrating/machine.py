"""Rows of `elbowroom bench calibration`: cameras from the machine itself, and real cameras refined on their scene."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import chi2

from elbowroom.calibrate.from_machine.target import calibrate_from_machine
from elbowroom.calibrate.refinement.agreement import Agreement, agreement
from elbowroom.calibrate.refinement.refine import refine
from elbowroom.errors import InputError
from elbowroom.evaluate.examples import EXAMPLES, example
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.twist import between, moved, sizes
from elbowroom.sensing import NOISE_PRESETS, Snapshot
from elbowroom.sensing.planar_images import planar_images
from elbowroom.simulate import InterventionRoom, Optics, render, wall_cameras
from elbowroom.site import Site
from elbowroom.sources import moments

ROUGH_M, ROUGH_DEG = 0.10, 5.0
"""How far the rough poses for `calibrate machine` are off, in a random direction each."""
REAL_M, REAL_DEG = 0.05, 3.0
"""How far the second real camera is off before `calibrate refine`."""
ROOM_M, ROOM_DEG = 0.02, 0.5
"""How far simulated cameras are off before they are refined."""
REAL_SITE = "piv_table_2cam"
"""The example with two real cameras."""
RANGE = Optics(min_depth_m=0.1, max_depth_m=8.0)
DUE_MACHINE = {"worst_mm": 8.0, "worst_deg": 0.2}
DUE_REAL = {"cam1 to cam2": 60.0, "cam2 to cam1": 77.0}
"""Share of co-visible pixels within 5 cm that the recording's README gives for its own poses [%]."""
Said = Callable[[str], None]


def machine_row(
    *,
    cameras: int = 21,
    size: str = "vga",
    poses: int = 12,
    noise: str = "kinect_v1",
    seed: int = 1,
    said: Said = lambda words: None,
) -> dict[str, Any]:
    """Cameras around the intervention room, people walking, found from the C-arm alone.

    Args:
        cameras, size: around the walls, at 2.4 m.
        poses: of the machine, drawn at random.
        noise: of the sensors.
        seed: of all random numbers.
        said: told what is being done.

    Returns:
        A row of kind "machine": worst and median error [mm, degrees], share of true poses inside the 95 % region,
        seconds from images to poses.
    """
    room, random = InterventionRoom(), np.random.default_rng([seed, 71])
    true = wall_cameras(cameras, size=size, noise=NOISE_PRESETS[noise], optics=RANGE)
    said(f"rendering {poses} poses")
    recorded = []
    for _ in range(poses):
        moment = room.random_moment(random)
        frames = tuple(render(true, moment, seed=seed))
        recorded.append(Snapshot(frames, dict(moment.joints), now_ns=moment.stamp_ns))
    rough = [_off(camera, ROUGH_M, ROUGH_DEG, random) for camera in true]
    # a first call that compiles
    calibrate_from_machine(room.machine, rough[:1], recorded)
    begun = time.perf_counter()
    found = calibrate_from_machine(room.machine, rough, recorded, progress=said)
    seconds = time.perf_counter() - begun
    twists = [
        between(one.camera.world_from_camera, camera.world_from_camera)
        for one, camera in zip(found.cameras, true, strict=True)
    ]
    off = np.array([sizes(twist) for twist in twists]) * (1e3, np.degrees(1.0))
    squares = [
        float(twist @ np.linalg.solve(one.covariance, twist))
        for twist, one in zip(twists, found.cameras, strict=True)
    ]
    return {
        "kind": "machine",
        "cameras": cameras,
        "size": size,
        "noise": noise,
        "poses": poses,
        "rough_mm": ROUGH_M * 1e3,
        "rough_deg": ROUGH_DEG,
        "worst_mm": float(off[:, 0].max()),
        "worst_deg": float(off[:, 1].max()),
        "median_mm": float(np.median(off[:, 0])),
        "median_deg": float(np.median(off[:, 1])),
        "inside_pct": 100.0 * float(np.mean(np.array(squares) < chi2.ppf(0.95, 6))),
        "seconds": seconds,
        "due": DUE_MACHINE,
    }


def room_refine_row(
    *,
    cameras: int = 21,
    size: str = "vga",
    noise: str = "kinect_v1",
    seed: int = 1,
    said: Said = lambda words: None,
) -> dict[str, Any]:
    """Cameras around the intervention room, each off at random, refined on what they see in common; the first holds.

    Args:
        cameras, size: around the walls, at 2.4 m.
        noise: of the sensors.
        seed: of all random numbers.
        said: told what is being done.

    Returns:
        A row of kind "refine": worst and median of the poses' errors [mm, degrees] before and after, seconds.
    """
    room, random = InterventionRoom(), np.random.default_rng([seed, 79])
    true = wall_cameras(cameras, size=size, noise=NOISE_PRESETS[noise], optics=RANGE)
    said(f"refining {cameras} cameras of the simulated room")
    moment = room.random_moment(random)
    recorded = [Snapshot(tuple(render(true, moment, seed=seed)), {}, now_ns=moment.stamp_ns)]
    given = (true[0], *(_off(camera, ROOM_M, ROOM_DEG, random) for camera in true[1:]))
    sure = np.diag([np.radians(ROOM_DEG) ** 2] * 3 + [ROOM_M**2] * 3)
    held = {camera.name: None if camera is true[0] else sure for camera in given}
    begun = time.perf_counter()
    found = refine(given, held, recorded, progress=said)
    seconds = time.perf_counter() - begun
    by_name = {one.camera.name: one.camera for one in found.cameras}
    off = np.array(
        [
            sizes(between(by_name[camera.name].world_from_camera, camera.world_from_camera))
            for camera in true
            if camera.name in by_name
        ]
    ) * (1e3, np.degrees(1.0))
    return {
        "kind": "refine",
        "start": f"{cameras} simulated cameras {size}, {ROOM_M * 100:g} cm, {ROOM_DEG:g} degrees off",
        "worst_mm": float(off[:, 0].max()),
        "worst_deg": float(off[:, 1].max()),
        "median_mm": float(np.median(off[:, 0])),
        "median_deg": float(np.median(off[:, 1])),
        "seconds": seconds,
    }


def refine_rows(
    examples: Path = EXAMPLES, *, seeds: Sequence[int] = (1, 2, 3), said: Said = lambda words: None
) -> Iterator[dict[str, Any]]:
    """Real cameras of piv_table_2cam, the second one off at random, refined on what both see.

    Agreement is measured at full resolution over all moments, with the poses that come with the recording as well.

    Args:
        examples: the folder of site files of recordings.
        seeds: a start of its own for each.
        said: told what is being done.

    Yields:
        Rows of kind "refine", one for the recording's own poses (start "calib.json") and one for each start; where the
        recording is absent a single row with a note.
    """
    try:
        site = Site.load(example(REAL_SITE, examples))
        own, recorded = site.cameras(), list(moments(site, joints={}))
    except InputError as error:
        yield {"kind": "refine", "skipped": True, "note": str(error)}
        return
    images = [
        planar_images(camera, [f for m in recorded for f in m.frames if f.camera == camera.name], 1)
        for camera in own
    ]

    def shares(cameras: Sequence[DepthCamera]) -> dict[str, float]:
        result = {}
        for one, other in ((0, 1), (1, 0)):
            total = Agreement(0, 0, 0, 0)
            for a, b in zip(images[one].depth_m, images[other].depth_m, strict=True):
                total += agreement(cameras[one], a, cameras[other], b)
            result[f"{own[one].name} to {own[other].name}"] = total.agree_pct
        return result

    yield {"kind": "refine", "start": "calib.json", "agree_pct": shares(own), "due": DUE_REAL}
    sure = np.diag([np.radians(REAL_DEG) ** 2] * 3 + [REAL_M**2] * 3)
    for seed in seeds:
        said(f"refining from start {seed}")
        given = (own[0], _off(own[1], REAL_M, REAL_DEG, np.random.default_rng([seed, 73])))
        begun = time.perf_counter()
        found = refine(given, {own[0].name: None, own[1].name: sure}, recorded)
        seconds = time.perf_counter() - begun
        yield {
            "kind": "refine",
            "start": f"{REAL_M * 100:g} cm, {REAL_DEG:g} degrees off ({seed})",
            "agree_before_pct": shares(given),
            "agree_pct": shares((own[0], found.cameras[0].camera)),
            "seconds": seconds,
            "due": DUE_REAL,
        }


def _off(camera: DepthCamera, metres: float, degrees: float, random: np.random.Generator) -> DepthCamera:
    """The camera moved and turned by exactly so much, in random directions."""
    turn, way = random.standard_normal(3), random.standard_normal(3)
    twist = np.concatenate(
        [np.radians(degrees) * turn / np.linalg.norm(turn), metres * way / np.linalg.norm(way)]
    )
    return replace(camera, world_from_camera=moved(camera.world_from_camera, twist))
