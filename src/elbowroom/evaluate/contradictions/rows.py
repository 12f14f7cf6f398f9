"""How many wrong cameras are named, how many right ones are accused, and what looking costs."""

import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.contradictions.rooms import MARGIN, RandomSite, random_site
from elbowroom.evaluate.contradictions.wrongs import KINDS, Kind, Wrong
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.examples import EXAMPLES, example
from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.reconstruct.contradiction.findings import COMPARED, LIMIT, contradictions, found_in
from elbowroom.reconstruct.contradiction.suspicion import share_of
from elbowroom.reconstruct.contradiction.views import Views
from elbowroom.simulate import InterventionRoom, Optics, render, wall_cameras
from elbowroom.simulate.inside import hung_clear
from elbowroom.site import Site
from elbowroom.sources import open_room

Row = dict[str, Any]
Tell = Callable[[str], None]
RECORDED = ("apc_wrist_multiview", "kinect_board_2cam", "piv_table_2cam", "sevenscenes")
HEIGHTS_M = (2.4, 0.4)
TIMES_S = (3.0, 40.0, 170.0)
"""Moments of the simulated room at which its cameras are looked at."""
NAMED_PCT, WARNED_PCT = 95.0, 1.0

DUE: Mapping[str, tuple[Due, ...]] = {
    "wrong": (Due("milder", "≤", 0, words="verdicts milder than stop above the limit"),),
    "all wrong": (Due("named_pct", "≥", NAMED_PCT, words="named, and no others"),),
    "right": (
        Due("stopped", "≤", 0, words="right sites refused"),
        Due("warned_pct", "≤", WARNED_PCT, words="warned of"),
    ),
}
"""What is due, by the kind of row."""


def contradiction_rows(
    tell: Tell, *, sites: int = 20, right: int = 200, examples: Path = EXAMPLES
) -> Iterator[Row]:
    """A row for each way of describing cameras wrongly, one of all, then one of sites that are right.

    Args:
        tell: called with what is done next, in words.
        sites: random sites that are described wrongly in each way.
        right: random sites that are described rightly.
        examples: the folder of site files of recordings.
    """
    rows = {name: _new_row(name) for name in KINDS}
    for number in range(sites):
        tell(f"wrong cameras, site {number + 1} of {sites}")
        site = random_site(number)
        for name, kind in KINDS.items():
            _add(rows[name], site, kind, number)
    yield from rows.values()
    named = sum(row["named"] for row in rows.values())
    yield {
        "kind": "all wrong",
        "sites": sites,
        "ways": len(KINDS),
        "named": named,
        "named_pct": 100.0 * named / (sites * len(KINDS)),
        "stopped": sum(row["stopped"] for row in rows.values()),
    }
    yield _right_row(tell, right, examples)


def _new_row(name: str) -> Row:
    counts = ("sites", "named", "stopped", "milder")
    return {"kind": "wrong", "what": name, **dict.fromkeys(counts, 0), "missed": []}


def _add(row: Row, site: RandomSite, kind: Kind, number: int) -> None:
    """Describes a site wrongly, looks, and counts."""
    wrong = kind(np.random.default_rng([21, number]), site)
    views = Views.of(wrong.cameras, site.snapshot.frames, MARGIN)
    found = found_in(views)
    is_named = {name for finding in found for name in finding.about} == wrong.named
    stops = any(finding.stops for finding in found)
    row["sites"] += 1
    row["named"] += is_named
    row["stopped"] += stops
    row["milder"] += _is_above_limit(views, wrong) and not stops
    if not is_named:
        row["missed"].append(number)


def _is_above_limit(views: Views, wrong: Wrong) -> bool:
    """Whether some wrong camera's comparisons are contradictions beyond the limit."""
    everybody = range(len(views.eyes))
    shares = (share_of(views.pairs, (n,), everybody) for n in everybody if views.eyes[n].name in wrong.named)
    return any(share.value > LIMIT and share.compared >= COMPARED for share in shares)


def _right_row(tell: Tell, right: int, examples: Path) -> Row:
    """Findings about sites that are right: none are due."""
    findings: dict[str, tuple[Finding, ...]] = {}
    first_ms = []
    for number in range(right):
        if number % 20 == 0:
            tell(f"right cameras, site {number + 1} of {right}")
        # those after the ones that thresholds were chosen by
        site = random_site(1000 + number)
        begun = time.perf_counter()
        findings[f"random {1000 + number}"] = contradictions(site.cameras, site.snapshot.frames, MARGIN)
        first_ms.append((time.perf_counter() - begun) * 1e3)
    tell("the simulated room")
    findings.update(_theatres())
    tell("recordings")
    findings.update(_recorded(examples))
    told = {name: found for name, found in findings.items() if found}
    stopped = sum(any(finding.stops for finding in found) for found in told.values())
    return {
        "kind": "right",
        "sites": len(findings),
        "stopped": stopped,
        "warned": len(told) - stopped,
        "warned_pct": 100.0 * (len(told) - stopped) / len(findings),
        "told": {name: [finding.text for finding in found] for name, found in told.items()},
        "first_median_ms": float(np.median(first_ms)) if first_ms else None,
    }


def _theatres() -> Iterator[tuple[str, tuple[Finding, ...]]]:
    """The simulated room as `monitor` shows it, and with few cameras."""
    room = InterventionRoom()
    optics = Optics(min_depth_m=0.1, max_depth_m=8.0)
    for count in (4, 8, 21):
        for time_s in TIMES_S:
            hung = wall_cameras(count, HEIGHTS_M, size="qqvga", optics=optics)
            cameras: tuple[DepthCamera, ...] = hung_clear(hung, room.solids)
            frames = render(cameras, room.at(time_s), seed=count)
            yield f"room, {count} cameras, {time_s:g} s", contradictions(cameras, frames, MARGIN)


def _recorded(examples: Path) -> Iterator[tuple[str, tuple[Finding, ...]]]:
    """Recordings of real cameras, where they are there."""
    for name in RECORDED:
        try:
            room = open_room(Site.load(example(name, examples)))
            frames = room.snapshot(0).frames
        except InputError:
            continue
        yield name, contradictions(room.cameras, frames, room.terms.margin)
