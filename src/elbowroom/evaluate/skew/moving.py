"""A ball and people who walk, past cameras that are not exposed together: what of them is declared free?"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.choices import LAWFUL
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.skew.exposures import (
    NOW_S,
    SPREADS_MS,
    Scene,
    ages_ms,
    exposed,
    falsely_free,
    free_between_rays,
)
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Solid, wall_cameras
from elbowroom.simulate.person import STRIDE_M, Person, Stance, Walk
from elbowroom.simulate.shapes import ellipsoid, join

BALL_M = 0.06
"""Radius of the ball: a fist."""
BALL_SPEEDS_M_S = (1.6, 2.0)
WALK_SPEEDS_M_S = (1.2, 1.6)
BALL_VOXEL_M, WALKER_VOXEL_M = 0.02, 0.03
ROUND_GAIT = 720
"""A stride of people who are looked at within milliseconds has so many shapes."""


def _is_due(row: Mapping[str, Any]) -> bool:
    """Of things that go no faster than the law says, lawful rules, a spread up to 100 ms."""
    if "lateral_px" in row:
        return False
    slow = row["law_m_s"] >= row["speed_m_s"]
    return bool(slow and row["rule"] in LAWFUL and 0 < row["spread_ms"] <= 100)


DUE = (
    Due(
        "false_free_voxels",
        "≤",
        0,
        _is_due,
        "touched voxels of what goes no faster than the law says, free up to 100 ms",
    ),
    Due(
        "false_free_voxels",
        "≤",
        0,
        lambda row: row.get("lateral_px", 0.0) > 0,
        "touched voxels that are free although nothing is aged, with a margin to the side",
    ),
)


def moving_rows(places: int = 6, cameras: int = 12, seed: int = 1) -> Iterator[dict[str, object]]:
    """Balls and walkers at some places, without noise and with it, by spread of ages, law, detail and rule.

    Args:
        places: of each thing at each speed.
        cameras: along the walls at 2.4 and 0.4 m in turn, 640 x 480.
        seed: of places, ways and ages.

    Yields:
        Rows of what, noise, speed_m_s, fastest_m_s, spread_ms, law_m_s, detail, rule, touched, false_free_voxels; and
        of exact images of one time, lateral_px instead of the law.
    """
    for number, scene in enumerate(_scenes(places, seed)):
        shared = {"what": scene.what, "speed_m_s": scene.speed_m_s, "fastest_m_s": scene.fastest_m_s}
        for noise in (False, True):
            views = wall_cameras(cameras, (2.4, 0.4), noise=NOISE_PRESETS["tof"] if noise else None)
            for spread_ms in SPREADS_MS:
                ages = ages_ms(cameras, spread_ms, seed + number)
                frames = exposed(scene, views, ages, noise)
                said = {**shared, "noise": noise, "spread_ms": spread_ms}
                yield from ({**said, **row} for row in falsely_free(scene, views, frames, ages))
                if not noise and spread_ms == 0:
                    yield from ({**said, **row} for row in free_between_rays(scene, views, frames))


def _scenes(places: int, seed: int) -> Iterator[Scene]:
    rng = np.random.default_rng(seed)
    for _ in range(places):
        for speed in BALL_SPEEDS_M_S:
            yield _ball(rng, speed)
        for speed in WALK_SPEEDS_M_S:
            yield _walker(rng, speed)


def _ball(rng: np.random.Generator, speed_m_s: float) -> Scene:
    """A ball on a straight way, in any direction."""
    way = rng.normal(size=3)
    way *= speed_m_s / np.linalg.norm(way)
    place = rng.uniform((-0.9, -0.9, 0.6), (0.9, 0.9, 1.8))
    mesh = Solid("ball", join([ellipsoid((0, 0, 0), (BALL_M,) * 3, 24, 40)]), np.eye(4)).mesh

    def at(time_s: float) -> tuple[Solid, ...]:
        pose = np.eye(4)
        pose[:3, 3] = place + way * (time_s - NOW_S)
        return (Solid("ball", mesh, pose),)

    return Scene("ball", _about(place, (0.2, 0.2, 0.2), BALL_VOXEL_M), at, speed_m_s)


def _walker(rng: np.random.Generator, speed_m_s: float) -> Scene:
    """A person who walks straight on and swings the arms."""
    heading, phase = rng.uniform(-math.pi, math.pi), rng.uniform(0, 2 * math.pi)
    place = rng.uniform((-0.6, -0.6), (0.6, 0.6))
    person = Person("walker", Walk((0, 0), (1, 1), 1.0), phases=ROUND_GAIT)

    def at(time_s: float) -> tuple[Solid, ...]:
        walked = speed_m_s * (time_s - NOW_S)
        x, y = place + walked * np.array([math.cos(heading), math.sin(heading)])
        stance = Stance(float(x), float(y), heading, phase + 2 * math.pi * walked / STRIDE_M)
        return person.solids(stance)

    middle = np.array([*place, 0.95])
    return Scene("walker", _about(middle, (0.6, 0.6, 0.95), WALKER_VOXEL_M), at, speed_m_s)


def _about(place: Any, half_m: Sequence[float], voxel_size_m: float) -> VoxelGrid:
    lower, upper = np.array(place) - half_m, np.array(place) + half_m
    return VoxelGrid.covering(lower, upper, voxel_size_m)


def moving_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows over all places, of kind "moving" or, of one time and by margin to the side, "still".

    Args:
        rows: of `moving_rows`.
    """
    aged = ("what", "speed_m_s", "noise", "spread_ms", "law_m_s", "detail", "rule")
    still = ("what", "speed_m_s", "lateral_px")
    groups: dict[tuple[tuple[str, Any], ...], list[Mapping[str, Any]]] = {}
    for row in rows:
        keys = still if "lateral_px" in row else aged
        groups.setdefault(tuple((key, row[key]) for key in keys), []).append(row)
    summary = []
    for values, own in groups.items():
        touched, false = (sum(row[key] for row in own) for key in ("touched", "false_free_voxels"))
        summary.append(
            {
                "kind": "still" if "lateral_px" in own[0] else "moving",
                **dict(values),
                "fastest_m_s": max(row["fastest_m_s"] for row in own),
                "places": len(own),
                "touched": touched,
                "false_free_voxels": false,
                "false_pct": 100 * false / touched,
            }
        )
    return summary
