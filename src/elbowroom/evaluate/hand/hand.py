"""A hand close to an arm whose collision geometry is larger than it is: is any motion that meets it clear?"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.hand.arms import ARMS, Arm
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.motion import Level, Motion, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render, wall_cameras
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.shapes import ellipsoid, join

GRID = VoxelGrid((-2.0, -2.0, 0.0), (200, 200, 125), 0.02)
RADIUS_M, GAP_M = 0.05, 0.01
"""Of the hand, a ball; and how far from the arm it is, at most."""
BRAKING_RAD = 0.12
"""S of each joint: a hand's breadth at the end of an arm."""
STEPS = 60
"""At so many places along S it is looked whether the arm meets the hand."""
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
        arms: of `ARMS`.
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
            rng = np.random.default_rng((seed, list(ARMS).index(name)))
            with TemporaryDirectory() as folder:
                by_words: tuple[ExplainWith, ExplainWith] = ("auto", "collision")
                explained = {words: Arm.in_folder(name, Path(folder), words) for words in by_words}
            for scene in range(scenes):
                shared = {"kind": "verdict", "arm": name, "scene": scene, "noise": preset, "seed": seed}
                yield from ({**shared, **row} for row in _scene_rows(explained, views, rng))


def _scene_rows(
    arms: Mapping[ExplainWith, Arm], views: tuple[DepthCamera, ...], rng: np.random.Generator
) -> Iterator[dict[str, object]]:
    arm = arms["auto"]
    joints, hand = _place(arm, rng)
    motions = [Motion(joint, way, BRAKING_RAD) for joint in arm.machine.joint_names for way in (1, -1)]
    meets = [_meets(arm, joints, motion, hand) for motion in motions]
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


def _place(arm: Arm, rng: np.random.Generator) -> tuple[dict[str, float], NDArray[np.float64]]:
    """A pose of the arm in which it keeps clear of floor and post, and a hand close to it that touches nothing."""
    for _ in range(TRIES):
        joints = {"turn": rng.uniform(-2, 2), "lift": rng.uniform(-0.9, 0.5), "bend": rng.uniform(-1.2, 1.2)}
        placed = arm.machine.world_from_links(joints)
        link = ("upper", "lower")[rng.integers(2)]
        edges, middle = arm.real[link][rng.integers(len(arm.real[link]))]
        # a point on one of its faces, and the ball that rests on it
        at, axis, way = rng.uniform(-0.5, 0.5, 3), rng.integers(3), rng.choice((-1.0, 1.0))
        at[axis] = 0.5 * way
        point = at * edges + middle
        point[axis] += way * (RADIUS_M + rng.uniform(0.001, GAP_M))
        hand = placed[link][:3, :3] @ point + placed[link][:3, 3]
        lowest = min(_corners_z(placed[link_name], arm.real[link_name]) for link_name in ("upper", "lower"))
        if not (lowest > 0.1 and hand[2] > 0.2 and arm.distance(joints, hand) > RADIUS_M):
            continue
        if arm.is_in_excess(joints, hand) or rng.random() < OUTSIDE:
            return joints, hand
    raise RuntimeError(f"{arm.name}: no place for a hand in {TRIES} tries")


def _corners_z(world_from_link: NDArray[np.float64], boxes: Sequence[Any]) -> float:
    """The least height of a link's boxes, or less [m]."""
    return min(
        float((world_from_link[:3, :3] @ middle + world_from_link[:3, 3])[2] - np.linalg.norm(edges) / 2)
        for edges, middle in boxes
    )


def _meets(arm: Arm, joints: Mapping[str, float], motion: Motion, hand: NDArray[np.float64]) -> bool:
    """Whether the arm itself meets the hand within the braking distance of a motion."""
    for travel in np.linspace(0.0, motion.braking_distance, STEPS):
        there = {**joints, motion.joint: joints[motion.joint] + motion.direction * travel}
        if arm.distance(there, hand) < RADIUS_M:
            return True
    return False


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
