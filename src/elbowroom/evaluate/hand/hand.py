"""A hand close to an arm whose collision geometry is larger than it is: is any motion that meets it clear?"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.hand.arms import ARMS, Arm
from elbowroom.evaluate.hand.published import PUBLISHED, PublishedArm, turning
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.motion import Level, Motion, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render, wall_cameras
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.shapes import ellipsoid, join

AnyArm = Arm | PublishedArm
EVERY = (*ARMS, *PUBLISHED)
GRID = VoxelGrid((-2.0, -2.0, 0.0), (200, 200, 125), 0.02)
RADIUS_M, GAP_M = 0.05, 0.01
"""Of the hand, a ball; and how far from the arm it is, at most."""
BRAKING_RAD = 0.12
"""S of each joint: a hand's breadth at the end of an arm."""
OUTSIDE = 0.1
"""Of the places that lie in no link's collision geometry, so many are taken."""
TRIES = 2000
BY_DEFAULT = where(explain_with="auto")
DUE = (
    Due("clear", "≤", 0, words="clear"),
    Due(
        "alone_stop_pct",
        "≤",
        5.0,
        BY_DEFAULT,
        "stops of the machine alone that is explained by what is seen of it",
    ),
)
"""A hand is met whatever explains; the machine alone stops only where its model is larger than what is seen."""


def hand_rows(
    arms: Sequence[str] = tuple(ARMS),
    *,
    scenes: int = 25,
    cameras: int = 12,
    size: str = "vga",
    noise: Sequence[str] = ("tof",),
    seed: int = 3,
) -> Iterator[dict[str, object]]:
    """Each arm in random poses with a hand close by, and without; all motions judged from images of each noise.

    Args:
        arms: of `ARMS`, or of `PUBLISHED`.
        scenes: of each arm.
        cameras, size: along the walls, at 2.4 and 0.4 m in turn.
        noise: presets by name; "exact": none.
        seed: of poses and hands.

    Yields:
        A row of kind "verdict" for each scene, way of explaining, and motion that meets the hand, or all without one.
    """
    for preset in noise:
        views = wall_cameras(cameras, (2.4, 0.4), size=size, noise=NOISE_PRESETS.get(preset))
        for name in arms:
            rng = np.random.default_rng((seed, EVERY.index(name)))
            explained: Mapping[ExplainWith, AnyArm] = (
                Arm.both(name) if name in ARMS else PublishedArm.both(name)
            )
            for scene in range(scenes):
                shared = {"kind": "verdict", "arm": name, "scene": scene, "noise": preset, "seed": seed}
                yield from ({**shared, **row} for row in _scene_rows(explained, views, rng))


def _scene_rows(
    arms: Mapping[ExplainWith, AnyArm], views: tuple[DepthCamera, ...], rng: np.random.Generator
) -> Iterator[dict[str, object]]:
    arm = arms["auto"]
    joints, hand = _place(arm, rng)
    motions = [Motion(joint, way, BRAKING_RAD) for joint in turning(arm.machine) for way in (1, -1)]
    meets = [arm.meets(joints, motion, hand, RADIUS_M) for motion in motions]
    excess = arm.is_in_excess(joints, hand)
    solid = Solid("hand", join([ellipsoid(hand, (RADIUS_M,) * 3, 24, 40)]), np.eye(4))
    for what, things in (("hand", (solid,)), ("alone", ())):
        moment = Moment(0.0, (*shell(), *things, *link_solids(arm.machine, joints)), joints)
        frames = render(views, moment)
        for words, other in arms.items():
            space = reconstruct(
                GRID, views, frames, other.machine, joints, margin=Margin(lateral_px=0.0), looks=False
            )
            for verdict, meet in zip(
                check_motions(space, other.machine, joints, motions), meets, strict=True
            ):
                if meet or what == "alone":
                    row = verdict.row()
                    said = {
                        key: row[key]
                        for key in ("joint", "direction", "level", "cause", "free_travel", "link")
                    }
                    yield {"what": what, "explain_with": words, "in_excess": excess, **said}


def _place(arm: AnyArm, rng: np.random.Generator) -> tuple[dict[str, float], NDArray[np.float64]]:
    """A pose of the arm in which it keeps clear of the floor, and a hand close to it that touches nothing."""
    for _ in range(TRIES):
        joints = arm.draw(rng)
        # the ball that rests on one of its faces
        hand = arm.beside(joints, (RADIUS_M + 0.001, RADIUS_M + GAP_M), rng)
        if not (arm.lowest_m(joints) > 0.1 and hand[2] > 0.2 and arm.distance(joints, hand) > RADIUS_M):
            continue
        if not arm.is_in_the_open(joints, hand):
            continue
        if arm.is_in_excess(joints, hand) or rng.random() < OUTSIDE:
            return joints, hand
    raise RuntimeError(f"{arm.name}: no place for a hand in {TRIES} tries")


def hand_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row of kind "summary" for each noise and way of explaining in rows of `hand_rows`."""
    summary = []
    for preset, words in dict.fromkeys((row["noise"], row["explain_with"]) for row in rows):
        own = [row for row in rows if (row["noise"], row["explain_with"]) == (preset, words)]
        met = [row for row in own if row["what"] == "hand"]
        alone = [row["level"] for row in own if row["what"] == "alone" and row["cause"] != "machine"]
        levels = [row["level"] for row in met]
        summary.append(
            {
                "kind": "summary",
                "noise": preset,
                "explain_with": words,
                "arms": len({row["arm"] for row in own}),
                "motions": len(met),
                "in_excess": sum(bool(row["in_excess"]) for row in met),
                **{level.name.lower(): levels.count(level.name.lower()) for level in Level},
                "alone": len(alone),
                "alone_stop_pct": 100 * alone.count("stop") / max(1, len(alone)),
            }
        )
    return summary
