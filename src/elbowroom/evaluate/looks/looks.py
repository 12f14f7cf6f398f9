"""Rows of the looks: one for each room that is right, one for each that was made wrong, and what they come to."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from time import perf_counter
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.looks.random_site import random_site
from elbowroom.evaluate.looks.rooms import random_scenes
from elbowroom.evaluate.looks.scaled import is_much
from elbowroom.evaluate.looks.scene import Scene
from elbowroom.evaluate.looks.wrong import WRONG, Wrong
from elbowroom.reconstruct.looking import found_at

Row = Mapping[str, Any]
RIGHT, WRONG_KIND, SCALED_KIND = "right", "wrong", "scaled"
DUE = (
    Due("refused", "≤", 0, where(what=RIGHT), "rooms that are right and are refused"),
    Due("warned_pct", "≤", 1, where(what=RIGHT), "of them are warned of"),
    Due("unsaid", "≤", 0, where(what=WRONG_KIND), "wrong rooms of which nothing is said"),
    Due(
        "unsaid_pct",
        "≤",
        10,
        where(what=SCALED_KIND, is_much=True),
        "rooms with focal lengths a fifth off of which nothing is said",
    ),
)


def right_rows(count: int, rooms: Iterable[Scene] = ()) -> Iterator[Row]:
    """Of rooms that are right: anything that is found is a false alarm.

    Args:
        count: of random sites.
        rooms: others, before them.
    """
    for scene in chain(rooms, random_scenes(count)):
        findings = scene.findings()
        took_ms = _ms(scene)
        yield {
            "what": RIGHT,
            "scene": scene.name,
            "cameras": len(scene.cameras),
            "stops": any(finding.stops for finding in findings),
            "warns": bool(findings),
            "ms_a_camera": round(took_ms / len(scene.cameras), 3),
            "said": [finding.text for finding in findings],
        }


def _ms(scene: Scene) -> float:
    """What all looks take, at the second time: rays of cameras and shares of lenses are kept."""
    frames = scene.frames
    begun = perf_counter()
    found_at(scene.grid, scene.cameras, frames, scene.units_m)
    return (perf_counter() - begun) * 1e3


def wrong_rows(count: int, kinds: Mapping[str, Wrong] = WRONG, what: str = WRONG_KIND) -> Iterator[Row]:
    """Of random sites that were made wrong, each in each kind.

    Args:
        count: of random sites; others than those that are right.
        kinds: by name.
        what: rows are of.
    """
    for number in range(count):
        scene = random_site(10_000 + number)
        for kind, wrong in kinds.items():
            yield {"what": what, "kind": kind, "scene": scene.name, **_found(scene, wrong, number)}


def _found(scene: Scene, wrong: Wrong, seed: int) -> dict[str, Any]:
    try:
        findings = wrong.change(scene, np.random.default_rng(seed)).findings()
    except InputError:  # refused where values enter, before any look
        return {"said_at_all": True, "named": True, "stops": True}
    named = [finding for finding in findings if finding.kind in wrong.kinds or not wrong.kinds]
    return {
        "said_at_all": bool(findings),
        "named": bool(named),
        "stops": any(finding.stops for finding in findings),
    }


def looks_summary(rows: Sequence[Row]) -> list[Row]:
    """One line for what is right, and one for each kind of what is wrong."""
    right = [row for row in rows if row["what"] == RIGHT]
    summary: list[Row] = []
    if right:
        summary.append(
            {
                "what": RIGHT,
                "kind": "as it should be",
                "scenes": len(right),
                "refused": sum(row["stops"] for row in right),
                "warned": sum(row["warns"] for row in right),
                "warned_pct": 100 * sum(row["warns"] for row in right) / len(right),
                "median_ms_a_camera": float(np.median([row["ms_a_camera"] for row in right])),
            }
        )
    for what, kind in dict.fromkeys((row["what"], row["kind"]) for row in rows if row["what"] != RIGHT):
        of_kind = [row for row in rows if row.get("kind") == kind]
        of_scale = {"is_much": is_much(kind)} if what == SCALED_KIND else {}
        summary.append(
            {
                "what": what,
                "kind": kind,
                **of_scale,
                "scenes": len(of_kind),
                "stopped": sum(row["stops"] for row in of_kind),
                "named": sum(row["named"] for row in of_kind),
                "unsaid": sum(not row["said_at_all"] for row in of_kind),
                "unsaid_pct": 100 * sum(not row["said_at_all"] for row in of_kind) / len(of_kind),
            }
        )
    return summary
