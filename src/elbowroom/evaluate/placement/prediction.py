"""What is predicted of a layout in random scenes, beside what `reconstruct` finds."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.placement.effort import Effort
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.placement import FixedRoom, Rehearsal, Settings, random_scenes, rehearse
from elbowroom.reconstruct import Terms, reconstruct
from elbowroom.simulate import InterventionRoom, Moment, render, true_occupancy, wall_cameras
from elbowroom.simulate.inside import hung_clear
from elbowroom.simulate.setups import SETUPS
from elbowroom.site import Site

CAMERAS = 21
HEIGHTS_M, VOXEL_M = (2.4, 0.4, 2.4), 0.05
SETUP_SITE = """
grid: {{origin_m: [-2.0, -2.0, 0.0], upper_m: [2.0, 2.0, 2.5], voxel_size_m: 0.05}}
machine: {{builtin: ceiling_c_arm}}
room: {{mesh: {name}}}
placement: {{}}
"""

DUE: dict[str, tuple[Due, ...]] = {"prediction": (Due("difference_pct", "≤", 1.0),)}
"""By the kind of row; a difference is due without its sign."""


def room_rows(effort: Effort) -> Iterator[dict[str, Any]]:
    """Random scenes of the simulated room beside `reconstruct` at moments of its own course, by size of image."""
    site = Site.simulated_room()
    settings = in_use(site)
    for size in ("vga", "qqvga"):
        cameras = hung_clear(wall_cameras(CAMERAS, HEIGHTS_M, size=size), InterventionRoom().solids)
        scenes = random_scenes(site, settings.grid, None, effort.scenes, seed=1)
        predicted = rehearse(cameras, scenes, settings, by_camera=False)
        room = InterventionRoom(machine=settings.machine)
        found = [found_pct(cameras, room.at(time_s), settings) for time_s in effort.moments_s]
        said = {"kind": "prediction", "room": "simulated room", "size": size}
        yield said | compared([predicted], found)


def setup_rows(effort: Effort) -> Iterator[dict[str, Any]]:
    """The thesis' six setups as fixed rooms, the machine in random poses, beside `reconstruct` in the setups' own."""
    cameras = wall_cameras(CAMERAS, HEIGHTS_M[:2], size="vga")
    predicted, found = [], []
    for shipped in SETUPS:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "site.yaml"
            path.write_text(SETUP_SITE.format(name=shipped.name), encoding="utf-8")
            site = Site.load(path)
        settings, room = in_use(site), FixedRoom.of_site(site)
        scenes = random_scenes(site, settings.grid, room, effort.setup_scenes, people=0, table=False, seed=1)
        predicted.append(rehearse(cameras, scenes, settings, by_camera=False))
        assert settings.machine is not None
        found.append(found_pct(cameras, shipped.at(settings.machine), settings))
    yield {"kind": "prediction", "room": "six setups", "size": "vga"} | compared(predicted, found)


def in_use(site: Site) -> Settings:
    """How the site declares space free, at 5 cm."""
    machine = site.machine()
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), VOXEL_M)
    return Settings(grid, Terms(margin=site.margin()), machine)


def found_pct(cameras: Sequence[DepthCamera], moment: Moment, settings: Settings) -> float:
    """Share of the truly free space that `reconstruct` finds [%].

    Args:
        cameras: that look.
        moment: what is there.
        settings: how space is declared free.
    """
    space = reconstruct(
        settings.grid,
        cameras,
        render(cameras, moment),
        settings.machine,
        moment.joints,
        margin=settings.terms.margin,
        looks=False,
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
