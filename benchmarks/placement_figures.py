"""Figures of `elbowroom placement` beside what is due: python benchmarks/placement_figures.py

Writes benchmarks/results/placement_figures.json. Takes some five minutes on two cores.
"""

import json
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.files.atomic import whole_file
from elbowroom.files.json_rows import meta
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.placement import (
    FixedRoom,
    Goal,
    Rehearsal,
    Search,
    Settings,
    candidates_of,
    even_cameras,
    known_sensors,
    optimise,
    random_scenes,
    rehearse,
    sweep,
    verify,
)
from elbowroom.reconstruct import Terms, reconstruct
from elbowroom.simulate import InterventionRoom, Moment, render, true_occupancy, wall_cameras
from elbowroom.simulate.setups import SETUPS
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM

OUT = Path(__file__).resolve().parent / "results" / "placement_figures.json"
AIM_M = 0.4
"""The best aim of evenly spread cameras of 640x480 in the thesis' room, as `placement sweep` finds it."""
MOMENTS_S = (0.0, 7.0, 19.0, 31.0, 43.0, 57.0)
SCENES, SETUP_SCENES, HEIGHTS_M, VOXEL_M = 12, 4, (2.4, 0.4, 2.4), 0.05
SETUP_SITE = """
grid: {{origin_m: [-2.0, -2.0, 0.0], upper_m: [2.0, 2.0, 2.5], voxel_size_m: 0.05}}
machine: {{builtin: ceiling_c_arm}}
room: {{mesh: {name}}}
placement: {{}}
"""


def verify_row() -> dict[str, Any]:
    """21 cameras, 4 x 4 x 2.5 m at 5 cm: best of five after one to compile."""
    site = Site.load(THESIS_ROOM)
    room, grid = FixedRoom.of_site(site), site.grid()
    assert room is not None and room.walls_m is not None
    cameras = even_cameras(room.walls_m, known_sensors()["vga"], 21, aim_m=AIM_M)
    times = []
    for _ in range(6):
        begun = time.perf_counter()
        found = verify(grid, cameras, room)
        times.append(time.perf_counter() - begun)
    row = {"kind": "verify", "cameras": 21, "points": grid.size, "valid_pct": found.valid_pct}
    return row | {"median_s": float(np.median(times[1:])), "max_s": max(times[1:])}


def sweep_row() -> dict[str, Any]:
    """The curve of Fig. 4: 38 layouts at 10 cm."""
    site = Site.load(THESIS_ROOM)
    room = FixedRoom.of_site(site)
    assert room is not None
    begun = time.perf_counter()
    done = sweep(site.grid(0.1), room, known_sensors()["vga"], range(3, 41))
    row = {"kind": "sweep", "layouts": len(done.counts), "voxel_size_m": 0.1, "aim_m": done.aim_m}
    shares = dict(zip(done.counts, done.valid_pct, strict=True))
    return row | {
        "seconds": time.perf_counter() - begun,
        "valid_21_pct": shares[21],
        "least_98_9": done.least(98.9),
    }


def optimise_row(share_pct: float, seconds: float, what: str) -> dict[str, Any]:
    """Fewest cameras for a share, 392 candidates, 20,000 points."""
    site = Site.load(THESIS_ROOM)
    room, grid = FixedRoom.of_site(site), site.grid()
    candidates = candidates_of(site, grid, room)
    done = optimise(grid, room, candidates, goal=Goal(share_pct), search=Search(seconds))
    first = next((at for at, count, _, _ in done.steps if count <= 19), None)
    return {
        "kind": "optimise",
        "what": what,
        "wanted_share_pct": share_pct,
        "cameras": len(done.cameras),
        "valid_pct": done.found.valid_pct,
        "solver_valid_pct": done.model_pct,
        "bound": done.bound,
        "candidates": done.candidates,
        "points": done.points,
        "seconds_asked": seconds,
        "seconds": done.seconds,
        "seconds_to_19": first,
    }


def prediction_row(size: str) -> dict[str, Any]:
    """Random scenes of the simulated room beside `reconstruct` at six moments of its own course."""
    site = Site.simulated_room()
    settings = in_use(site)
    cameras = wall_cameras(21, HEIGHTS_M, size=size)
    scenes = random_scenes(site, settings.grid, None, SCENES, seed=1)
    predicted = rehearse(cameras, scenes, settings, by_camera=False)
    room = InterventionRoom(machine=settings.machine)
    found = [found_pct(cameras, room.at(time_s), settings) for time_s in MOMENTS_S]
    return {"kind": "prediction", "room": "simulated room", "size": size} | compared([predicted], found)


def setups_row() -> dict[str, Any]:
    """The thesis' six setups as fixed rooms, the machine in random poses, beside `reconstruct` in the setups' own."""
    cameras = wall_cameras(21, HEIGHTS_M[:2], size="vga")
    predicted, found = [], []
    for shipped in SETUPS:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "site.yaml"
            path.write_text(SETUP_SITE.format(name=shipped.name), encoding="utf-8")
            site = Site.load(path)
        settings = in_use(site)
        room = FixedRoom.of_site(site)
        scenes = random_scenes(site, settings.grid, room, SETUP_SCENES, people=0, table=False, seed=1)
        predicted.append(rehearse(cameras, scenes, settings, by_camera=False))
        assert settings.machine is not None
        found.append(found_pct(cameras, shipped.at(settings.machine), settings))
    return {"kind": "prediction", "room": "six setups", "size": "vga"} | compared(predicted, found)


def in_use(site: Site) -> Settings:
    """How the site declares space free, at 5 cm."""
    machine = site.machine()
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), VOXEL_M)
    return Settings(grid, Terms(margin=site.margin()), machine)


def found_pct(cameras: Sequence[DepthCamera], moment: Moment, settings: Settings) -> float:
    """Share of the truly free space that `reconstruct` finds [%]."""
    space = reconstruct(
        settings.grid,
        cameras,
        render(cameras, moment),
        settings.machine,
        moment.joints,
        margin=settings.terms.margin,
    )
    truth = true_occupancy(settings.grid, moment)
    truly = ~truth.occupied & ~truth.machine
    return 100.0 * float((space.free & truly).sum()) / float(truly.sum())


def compared(predicted: Sequence[Rehearsal], found: Sequence[float]) -> dict[str, Any]:
    """What was predicted beside what was found; the worst is of a single room, where there are several."""
    shares = np.array([each.free_pct for each in predicted])
    apart = shares - (np.array(found) if len(shares) == len(found) else np.mean(found))
    return {
        "voxel_size_m": VOXEL_M,
        "scenes": sum(len(each.scenes) for each in predicted),
        "moments": len(found),
        "predicted_free_pct": float(shares.mean()),
        "predicted_error_pct": float(np.mean([each.free_error_pct for each in predicted])),
        "found_free_pct": float(np.mean(found)),
        "found_each_pct": list(found),
        "difference_pct": float(apart[np.argmax(np.abs(apart))]),
    }


def rows() -> Iterator[dict[str, Any]]:
    """All figures, one after the other."""
    verified = verify_row()
    yield verified
    yield sweep_row()
    yield optimise_row(98.9, 60.0, "98.9 % in 60 s")
    yield optimise_row(verified["valid_pct"], 60.0, "the share of 21 evenly spread")
    for size in ("vga", "qqvga"):
        yield prediction_row(size)
    yield setups_row()


def main() -> None:
    """Measures all of it."""
    said = meta() | {"command": "python benchmarks/placement_figures.py"}
    done = []
    for row in rows():
        print(json.dumps(row), file=sys.stderr)
        done.append(row)
    with whole_file(OUT) as unfinished:
        unfinished.write_text(json.dumps({"meta": said, "rows": done}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
