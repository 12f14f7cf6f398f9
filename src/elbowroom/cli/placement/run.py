"""The runs of `elbowroom placement verify` and `sweep`."""

import re
import time
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from elbowroom.cli.progress import Steps
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.cameras import cameras_of, requirement_of
from elbowroom.placement.charts import curve
from elbowroom.placement.even import Sweep, sweep
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import save, save_pictures
from elbowroom.placement.sensor import Sensor, known_sensors, sensors_of
from elbowroom.placement.verification import Verification, verify
from elbowroom.placement.worst import worst_places
from elbowroom.site import Site
from elbowroom.site.room_entry import BoxEntry, RoomEntry
from elbowroom.site.site import THESIS_ROOM

NO_WALLS = "the site has no key room: nothing blocks sight, and every pixel is taken to have a return"


def run_verify(
    site_path: Path,
    views: int | None,
    angle_deg: float | None,
    voxel_size_m: float | None,
    worst: int,
    out: Path | None,
    json_file: Path | None,
) -> None:
    """Verifies the cameras of a site and prints what they see."""
    site = Site.load(site_path)
    requirement = requirement_of(site, views, angle_deg)
    cameras, room, grid = cameras_of(site), FixedRoom.of_site(site), site.grid(voxel_size_m)
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 2) as steps:
            steps.begin("compiling kernels")
            verify(site.grid((grid.upper_m - grid.lower_m).min() / 2), cameras[:1], None, requirement)
            steps.begin(f"looking through {len(cameras)} cameras")
            begun = time.perf_counter()
            found = verify(grid, cameras, room, requirement)
            seconds = time.perf_counter() - begun
        row = verification_row(found, worst) | {"site": str(site.path), "name": site.name, "seconds": seconds}
        row["walls_known"] = room is not None
        files = [] if out is None else save_pictures(found, room, out, site.name)
        add(row | {"files": [str(path) for path in files]})
    say_verification(row)
    if room is None:
        print(f"note      {NO_WALLS}")
    for path in files:
        print(f"picture   {path}")


def verification_row(found: Verification, worst: int = 5) -> dict[str, Any]:
    """A row of kind "verify": shares [%], cameras, worst places."""
    return {
        "kind": "verify",
        "cameras": len(found.cameras),
        "voxel_size_m": found.grid.voxel_size_m,
        "points": int(found.asked.sum()),
        "views": found.requirement.views,
        "angle_deg": found.requirement.angle_deg,
        "valid_pct": found.valid_pct,
        "seen_by_one_pct": found.seen_pct(1),
        "seen_by_views_pct": found.seen_pct(found.requirement.views),
        "mean_views": float(found.counts[found.asked].mean()),
        "worst": [
            {
                "words": place.words,
                "lower_m": place.lower_m,
                "upper_m": place.upper_m,
                "voxels": place.voxels,
                "apart": place.apart,
                "cameras": place.cameras,
            }
            for place in worst_places(found, worst)
        ],
    }


def say_verification(row: dict[str, Any]) -> None:
    """Prints such a row."""
    print(
        f"valid     {row['valid_pct']:.2f} % of {row['points']:,} points of {row['voxel_size_m'] * 100:g} cm: "
        f"{row['views']} views, each two at least {row['angle_deg']:g} degrees apart"
    )
    print(
        f"seen      {row['seen_by_one_pct']:.2f} % by one camera or more, {row['seen_by_views_pct']:.2f} % by "
        f"{row['views']} or more; {row['mean_views']:.1f} of {row['cameras']} cameras on average"
    )
    for place in row["worst"]:
        print(f"worst     {place['words']}")


def run_sweep(
    site_path: Path | None,
    names: list[str] | None,
    counts_text: str,
    walls_m: list[float] | None,
    heights_m: tuple[float, ...],
    aim_m: float | None,
    share_pct: float,
    views: int | None,
    angle_deg: float | None,
    voxel_size_m: float,
    out: Path | None,
    json_file: Path | None,
) -> None:
    """Sweeps the number of cameras for each sensor and each size of room."""
    site = Site.load(THESIS_ROOM if site_path is None else site_path)
    requirement, counts = requirement_of(site, views, angle_deg), _counts(counts_text)
    if not 0 < share_pct <= 100:
        raise InputError(f"--share: {share_pct:g} %, must be above 0 and at most 100")
    sensors, rooms = _sensors(site, names, site_path is None), _rooms(site, walls_m)
    grid = site.grid(voxel_size_m)
    done: dict[str, Sweep] = {}
    table = Table(box=None, pad_edge=False)
    for column in ("room", "sensor", "aim", "at 12", "at 21", "at 40", "least", "time"):
        table.add_column(column, justify="left" if column in ("room", "sensor") else "right", no_wrap=True)
    console = Console(stderr=True)
    with json_rows(json_file) as add:
        for room_name, room in rooms.items():
            for sensor in sensors:
                with console.status("") as status:
                    what = f"{room_name}, {sensor.name}"
                    begun = time.perf_counter()
                    result = sweep(
                        grid,
                        room,
                        sensor,
                        counts,
                        requirement,
                        heights_m=heights_m,
                        aim_m=aim_m,
                        progress=lambda text, what=what: status.update(f"{what}: {text}"),  # type: ignore[misc]
                    )
                    seconds = time.perf_counter() - begun
                done[what] = result
                shares = dict(zip(result.counts, result.valid_pct, strict=True))
                least = result.least(share_pct)
                for count, valid, seen in zip(result.counts, result.valid_pct, result.seen_pct, strict=True):
                    add(
                        {
                            "kind": "layout",
                            "room": room_name,
                            "sensor": sensor.name,
                            "cameras": count,
                            "valid_pct": valid,
                            "seen_by_views_pct": seen,
                            "aim_m": result.aim_m,
                            "heights_m": heights_m,
                            "voxel_size_m": voxel_size_m,
                        }
                    )
                add(
                    {
                        "kind": "sweep",
                        "room": room_name,
                        "sensor": sensor.name,
                        "share_pct": share_pct,
                        "least_cameras": least,
                        "layouts": len(counts),
                        "best_valid_pct": max(result.valid_pct),
                        "seconds": seconds,
                    }
                )
                table.add_row(
                    room_name,
                    sensor.name,
                    f"{result.aim_m:g} m",
                    *(f"{shares[n]:.2f} %" if n in shares else "" for n in (12, 21, 40)),
                    "none" if least is None else str(least),
                    f"{seconds:.1f} s",
                )
        path = None if out is None else save(curve(done, requirement.views), folder(out) / "sweep.png")
    shown = Console(highlight=False)
    if not shown.is_terminal:
        shown.width = 120
    shown.print(table)
    shown.print(
        f"least: the smallest number with {share_pct:g} % of the points valid ({requirement.words})",
        style="dim",
    )
    if path is not None:
        print(f"picture   {path}")


def _counts(text: str) -> list[int]:
    match = re.fullmatch(r"([0-9]{1,3})-([0-9]{1,3})", text.strip())
    low, high = (int(match[1]), int(match[2])) if match else (0, 0)
    if not 1 <= low <= high <= 255:
        raise InputError(
            f"--cameras: {text!r} is no range of numbers; write FROM-TO, such as 3-40, up to 255"
        )
    return list(range(low, high + 1))


def _sensors(site: Site, names: list[str] | None, both: bool) -> list[Sensor]:
    """The sensors that are named; without names those of the site, or the two known ones."""
    known = known_sensors()
    if not names:
        return [known["thesis"], known["vga"]] if both else list(sensors_of(site))
    offered = known | {
        sensor.name: sensor for sensor in (sensors_of(site) if set(names) - set(known) else ())
    }
    for name in names:
        if name not in offered:
            raise InputError(f"--sensor: {name!r} is unknown, there are {', '.join(offered)}")
    return [offered[name] for name in names]


def _rooms(site: Site, walls_m: list[float] | None) -> dict[str, FixedRoom]:
    """The site's room, or square ones about its grid, floor and ceiling as the site's."""
    own = FixedRoom.of_site(site)
    if not walls_m:
        if own is None:
            raise InputError(f"{site.path}: room: missing; give walls there, or --walls")
        return {site.name: own}
    grid = site.grid()
    middle = (grid.lower_m + grid.upper_m) / 2
    low, high = grid.lower_m[2], grid.upper_m[2] + 0.4
    if own is not None and own.walls_m is not None:
        low, high = own.walls_m[:, 2]
    rooms = {}
    for side in walls_m:
        if not side > 0:
            raise InputError(f"--walls: {side:g} m, must be above 0")
        lower, upper = (
            (float(middle[0] + way * side / 2), float(middle[1] + way * side / 2), float(z))
            for way, z in ((-1, low), (1, high))
        )
        entry = RoomEntry(walls=BoxEntry(lower_m=lower, upper_m=upper))
        rooms[f"walls {side:g} m"] = FixedRoom.of_entry(entry, site.path.parent)
    return rooms
