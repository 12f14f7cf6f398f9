"""Layouts of cameras in the room of the thesis: time of verification and sweep, fewest cameras for a share."""

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.due import Due, Row
from elbowroom.evaluate.placement.effort import Effort
from elbowroom.geometry import DepthCamera
from elbowroom.placement import (
    FixedRoom,
    Goal,
    Search,
    candidates_of,
    even_cameras,
    known_sensors,
    optimise,
    sweep,
    verify,
)
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM

EVEN_CAMERAS = 21
"""Spread evenly, what a layout of the same share is compared with."""
EVEN_SHARE_PCT = 98.9
"""What the thesis says of them."""
AIM_M = 0.4
"""The best aim of evenly spread cameras of 640x480 in the thesis' room, as `placement sweep` finds it."""


def _fewer(row: Row) -> float:
    """As many as evenly spread for the thesis' share; for what they really reach three quarters of them."""
    return EVEN_CAMERAS if row["wanted_share_pct"] == EVEN_SHARE_PCT else EVEN_CAMERAS * 3 // 4


DUE: dict[str, tuple[Due, ...]] = {
    "verify": (Due("median_s", "≤", 1.0),),
    "sweep": (Due("seconds", "≤", 60.0),),
    "optimise": (
        Due("cameras", "≤", _fewer),
        Due("valid_pct", "≥", lambda row: round(row["wanted_share_pct"], 2)),
        Due("seconds_to_19", "≤", 300.0),
    ),
}
"""By the kind of row."""


def verify_rows(effort: Effort) -> Iterator[dict[str, Any]]:
    """21 cameras, 4 x 4 x 2.5 m at 5 cm."""
    site, room, walls_m = _thesis_room()
    grid, cameras = site.grid(), _even(walls_m)
    times = []
    for _ in range(1 + effort.verifications):
        begun = time.perf_counter()
        found = verify(grid, cameras, room)
        times.append(time.perf_counter() - begun)
    yield {
        "kind": "verify",
        "cameras": EVEN_CAMERAS,
        "points": grid.size,
        "valid_pct": found.valid_pct,
        "median_s": float(np.median(times[1:])),
        "max_s": max(times[1:]),
    }


def sweep_rows(effort: Effort) -> Iterator[dict[str, Any]]:
    """The curve of Fig. 4, at 10 cm."""
    site, room, _ = _thesis_room()
    begun = time.perf_counter()
    done = sweep(site.grid(0.1), room, known_sensors()["vga"], effort.counts)
    yield {
        "kind": "sweep",
        "layouts": len(done.counts),
        "voxel_size_m": 0.1,
        "aim_m": done.aim_m,
        "seconds": time.perf_counter() - begun,
        "valid_21_pct": dict(zip(done.counts, done.valid_pct, strict=True))[EVEN_CAMERAS],
        "least_98_9": done.least(EVEN_SHARE_PCT),
    }


def optimise_rows(effort: Effort) -> Iterator[dict[str, Any]]:
    """Fewest cameras for the thesis' share, and for the share that 21 evenly spread cameras really reach."""
    site, room, walls_m = _thesis_room()
    grid = site.grid()
    wanted = {
        f"{EVEN_SHARE_PCT} % in {effort.seconds:g} s": EVEN_SHARE_PCT,
        "the share of 21 evenly spread": verify(grid, _even(walls_m), room).valid_pct,
    }
    for what, share_pct in wanted.items():
        search = Search(effort.seconds)
        done = optimise(grid, room, candidates_of(site, grid, room), goal=Goal(share_pct), search=search)
        yield {
            "kind": "optimise",
            "what": what,
            "wanted_share_pct": share_pct,
            "cameras": len(done.cameras),
            "valid_pct": done.found.valid_pct,
            "solver_valid_pct": done.model_pct,
            "bound": done.bound,
            "candidates": done.candidates,
            "points": done.points,
            "seconds_asked": effort.seconds,
            "seconds": done.seconds,
            "seconds_to_19": next((at for at, count, _, _ in done.steps if count <= 19), None),
        }


def _even(walls_m: NDArray[np.float64]) -> tuple[DepthCamera, ...]:
    return even_cameras(walls_m, known_sensors()["vga"], EVEN_CAMERAS, aim_m=AIM_M)


def _thesis_room() -> tuple[Site, FixedRoom, NDArray[np.float64]]:
    """Site, room, and the inner faces of its walls."""
    site = Site.load(THESIS_ROOM)
    room = FixedRoom.of_site(site)
    assert room is not None and room.walls_m is not None
    return site, room, room.walls_m
