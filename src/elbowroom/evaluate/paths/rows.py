"""How far random paths may be followed, beside exact geometry: on the path, and with each joint braking by itself."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.paths.exact import LOOKS, ExactPath
from elbowroom.evaluate.paths.scenes import Name, PathScene, path_scenes
from elbowroom.evaluate.rooms.exact import Nearest
from elbowroom.evaluate.rooms.scene import SAME, settings_of
from elbowroom.motion import Cause, PathVerdict, check_path

ALONG, BESIDE = "along the path", "each joint by itself"
MOST_SHORT_VOXELS = 12
"""Where no stop is found that touches something so far beyond what is said to be safe, none is looked for."""
STEP_VOXELS = 0.5
"""Stops are tried every so many voxels of the way."""
DUE = (
    Due("beyond", "≤", 0, words="beyond the truth"),
    Due("median_shortfall_voxels", "≤", 2, words="median shortfall"),
)


def path_rows(
    paths: Mapping[Name, int], *, voxel_size_m: float = 0.02, seed: int = 1
) -> Iterator[dict[str, object]]:
    """Random paths in the volume of exact truth.

    Args:
        paths: how many of each machine.
        voxel_size_m: edge of a voxel [m].
        seed: of moments, poses, paths, and of the stops that are tried.

    Yields:
        Two rows of kind "path" for each path, by how the machine brakes. `shortfall_voxels`: the way of the point that
        touches, from where it is said to be safe to where it touches; beside the path: to where a stop was found that
        touches, so at most. None: nothing is touched, or no such stop was found.

    Raises:
        PackageError: coal, or the package with the UR5, is not installed.
    """
    for name, many in paths.items():
        for number, scene in enumerate(islice(path_scenes(name, voxel_size_m, seed), many)):
            exact = ExactPath(scene)
            said = {
                "kind": "path",
                "machine": name,
                "path": number,
                "voxel_size_m": voxel_size_m,
                "seed": seed,
            }
            for brakes, judge in ((ALONG, _along), (BESIDE, _beside)):
                braking = replace(scene.braking, leaves_path=brakes == BESIDE)
                verdict = check_path(scene.space, scene.machine, scene.path, scene.joints, braking)
                yield {
                    **said,
                    "brakes": brakes,
                    "duration_s": scene.path.end_s,
                    "with_velocities": scene.path.velocities is not None,
                    "level": verdict.level.name.lower(),
                    "cause": verdict.cause.name.lower(),
                    "follow_until_s": verdict.follow_until_s,
                    "rests_by_s": verdict.rests_by_s,
                    **judge(scene, exact, verdict, np.random.default_rng([seed, number])),
                }


def _along(
    scene: PathScene, exact: ExactPath, verdict: PathVerdict, _: np.random.Generator
) -> dict[str, object]:
    """Beside the first contact on the path."""
    contact = exact.first_contact()
    rests_s = verdict.blocked.time_s if verdict.blocked is not None else verdict.looked_until_s
    if contact is None:
        return {
            "true_s": None,
            "true_link": None,
            "true_solid": None,
            "beyond": False,
            "tried_beyond": False,
            "shortfall_voxels": None,
        }
    time_s, near = contact
    short = exact.way(near, min(rests_s, time_s), time_s) / scene.space.grid.voxel_size_m
    return {
        "true_s": time_s,
        "true_link": near.link,
        "true_solid": near.solid,
        "beyond": rests_s > time_s + SAME,
        "tried_beyond": False,
        "shortfall_voxels": short,
    }


def _beside(
    scene: PathScene, exact: ExactPath, verdict: PathVerdict, rng: np.random.Generator
) -> dict[str, object]:
    """Stops are tried before the last moment that is said to be safe, where none may touch, and from there on."""
    safe_s = verdict.follow_until_s
    before = np.linspace(scene.path.begin_s, safe_s, LOOKS) if safe_s is not None else ()
    tried = [exact.colliding_stop(float(time_s), rng) for time_s in before]
    found = next((stop for stop in tried if stop is not None), None)
    said: dict[str, object] = {
        "true_s": None,
        "true_link": None,
        "true_solid": None,
        "beyond": found is not None,
    }
    short = None
    if verdict.stop_blocked is not None:
        after = _next_touching(scene, exact, verdict.stop_blocked.time_s, rng)
        if after is not None:
            time_s, near, short = after
            said |= {"true_s": time_s, "true_link": near.link, "true_solid": near.solid}
    grid = verdict.cause is Cause.OUTSIDE_GRID  # there is no wall where the watched box ends
    tried_beyond = verdict.stop_blocked is not None and not grid
    return said | {"tried_beyond": tried_beyond, "shortfall_voxels": short}


def _next_touching(
    scene: PathScene, exact: ExactPath, safe_s: float, rng: np.random.Generator
) -> tuple[float, Nearest, float] | None:
    """The next moment from which a stop that touches was found, what touches, and the shortfall; None: none was."""
    edge, way, time_s = scene.space.grid.voxel_size_m, 0.0, safe_s
    while way <= MOST_SHORT_VOXELS * edge and time_s <= scene.path.end_s:
        found = exact.colliding_stop(time_s, rng)
        after_s = scene.braking.reaction_time_s
        if found is not None:
            near, beside = found
            here, there = (exact.joints(at + after_s, beside) for at in (safe_s, time_s))
            return time_s, near, exact.moved(near, here, there) / edge
        step = STEP_VOXELS * edge / exact.speed_at(time_s + after_s)
        time_s, way = time_s + step, way + STEP_VOXELS * edge
    return None


def path_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of kind "summary", by machine and by how it brakes.

    Args:
        rows: of `path_rows`.
    """
    found = []
    for machine in dict.fromkeys(row["machine"] for row in rows):
        for brakes in (ALONG, BESIDE):
            same = [row for row in rows if row["machine"] == machine and row["brakes"] == brakes]
            if same:
                found.append(_summed(same))
    return found


def _summed(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    short = [row["shortfall_voxels"] for row in rows if row["shortfall_voxels"] is not None]
    # where stops were tried and none touches, the shortfall is unknown, and counts as greater than all others
    unknown = sum(row["true_s"] is None and row["tried_beyond"] for row in rows)
    middle = float(np.median([*short, *[np.inf] * unknown])) if short or unknown else None
    ended = [row for row in rows if row["cause"] != "none"]
    return {
        **settings_of(rows),
        "machine": rows[0]["machine"],
        "brakes": rows[0]["brakes"],
        "paths": len(rows),
        "free_to_the_end": len(rows) - len(ended),
        "no_prefix": sum(row["follow_until_s"] is None for row in rows),
        "beyond": sum(row["beyond"] for row in rows),
        "compared": len(short) + unknown,
        "unknown": unknown,
        "median_shortfall_voxels": middle if middle is None or np.isfinite(middle) else None,
        "greatest_shortfall_voxels": max(short, default=None),
        "ended_without_truth": sum(row["true_s"] is None for row in ended),
        "ended_by_the_grid": sum(row["cause"] == "outside_grid" for row in ended),
    }
