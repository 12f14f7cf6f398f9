"""The run of `elbowroom placement sweep`."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from elbowroom.cli.placement.options import SweepOptions
from elbowroom.cli.placement.room import room_of
from elbowroom.cli.screen import note, show
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import AddRow, json_rows
from elbowroom.placement.charts import curve
from elbowroom.placement.even import Sweep, sweep
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import save
from elbowroom.placement.requirement import Requirement, requirement_of
from elbowroom.placement.sensor import Sensor, known_sensors, sensors_of
from elbowroom.site import Site
from elbowroom.site.room_entry import BoxEntry, RoomEntry
from elbowroom.site.site import THESIS_ROOM
from elbowroom.view.report.blocks import Table

TOLD = (12, 21, 40)
"""Numbers of cameras of which the share stands in the table."""


@dataclass(frozen=True, slots=True, eq=False)
class Swept:
    """One sensor in one room.

    Args:
        room, sensor: names.
        found: shares by the number of cameras.
        seconds: what it took.
    """

    room: str
    sensor: str
    found: Sweep
    seconds: float


def run_sweep(options: SweepOptions, json_file: Path | None) -> None:
    """Sweeps the number of cameras for each sensor and each size of room.

    Raises:
        InputError: a site, a range, a share, a sensor or walls that cannot be.
    """
    site = Site.load(THESIS_ROOM if options.site is None else options.site)
    requirement = requirement_of(site, options.required.views, options.required.angle_deg)
    counts = _counts(options.counts)
    if not 0 < options.share_pct <= 100:
        raise InputError(f"--share: {options.share_pct:g} %, must be above 0 and at most 100")
    sensors, rooms = _sensors(site, options), _rooms(site, options.walls_m)
    done: list[Swept] = []
    path = None
    with json_rows(json_file) as add:
        for name, room in rooms.items():
            for sensor in sensors:
                done.append(_swept(site, (name, room), sensor, counts, requirement, options))
                _add_rows(add, done[-1], options)
        if options.out is not None:
            picture = curve({f"{one.room}, {one.sensor}": one.found for one in done}, requirement.views)
            path = save(picture, folder(options.out) / "sweep.png")
    show(sweep_table(done, options.share_pct))
    share, words = options.share_pct, requirement.words
    note(f"least: the smallest number with {share:g} % of the points valid ({words})")
    if path is not None:
        print(f"picture   {path}")


def sweep_table(done: Sequence[Swept], share_pct: float) -> Table:
    """A line for each sensor in each room.

    Args:
        done: what was found.
        share_pct: of which the least number of cameras is told [%].
    """
    lines = []
    for one in done:
        shares = dict(zip(one.found.counts, one.found.valid_pct, strict=True))
        least = one.found.least(share_pct)
        lines.append(
            (
                one.room,
                one.sensor,
                f"{one.found.aim_m:g} m",
                *(f"{shares[n]:.2f} %" if n in shares else "" for n in TOLD),
                "none" if least is None else str(least),
                f"{one.seconds:.1f} s",
            )
        )
    columns = ("room", "sensor", "aim", *(f"at {n}" for n in TOLD), "least", "time")
    return Table("", columns, lines, left=(0, 1))


def _swept(
    site: Site,
    room: tuple[str, FixedRoom],
    sensor: Sensor,
    counts: Sequence[int],
    requirement: Requirement,
    options: SweepOptions,
) -> Swept:
    name, walls = room
    begun = time.perf_counter()
    with Console(stderr=True).status("") as status:
        found = sweep(
            site.grid(options.voxel_size_m),
            walls,
            sensor,
            counts,
            requirement,
            heights_m=options.heights_m,
            aim_m=options.aim_m,
            progress=lambda text: status.update(f"{name}, {sensor.name}: {text}"),
        )
    return Swept(name, sensor.name, found, time.perf_counter() - begun)


def _add_rows(add: AddRow, one: Swept, options: SweepOptions) -> None:
    which = {"room": one.room, "sensor": one.sensor}
    how = {"heights_m": options.heights_m, "voxel_size_m": options.voxel_size_m}
    for row in one.found.rows():
        add(row | which | how)
    add(one.found.row(options.share_pct) | which | {"seconds": one.seconds})


def _counts(text: str) -> list[int]:
    match = re.fullmatch(r"([0-9]{1,3})-([0-9]{1,3})", text.strip())
    low, high = (int(match[1]), int(match[2])) if match else (0, 0)
    if not 1 <= low <= high <= 255:
        raise InputError(
            f"--cameras: {text!r} is no range of numbers; write FROM-TO, such as 3-40, up to 255"
        )
    return list(range(low, high + 1))


def _sensors(site: Site, options: SweepOptions) -> list[Sensor]:
    """The sensors that are named; without names those of the site, or the two known ones."""
    known, names = known_sensors(), options.sensors
    if not names:
        return [known["thesis"], known["vga"]] if options.site is None else list(sensors_of(site))
    own = sensors_of(site) if set(names) - set(known) else ()
    offered = known | {sensor.name: sensor for sensor in own}
    for name in names:
        if name not in offered:
            raise InputError(f"--sensor: {name!r} is unknown, there are {', '.join(offered)}")
    return [offered[name] for name in names]


def _rooms(site: Site, walls_m: Sequence[float]) -> dict[str, FixedRoom]:
    """The site's room, or square ones about its grid, floor and ceiling as the site's."""
    own = room_of(site)
    if walls_m:
        return {f"walls {side:g} m": _square_room(site, own, side) for side in walls_m}
    if own is None:
        raise InputError(f"{site.path}: room: missing; give walls there, or --walls")
    return {site.name: own}


def _square_room(site: Site, own: FixedRoom | None, side: float) -> FixedRoom:
    if not side > 0:
        raise InputError(f"--walls: {side:g} m, must be above 0")
    grid = site.grid()
    x, y, _ = (grid.lower_m + grid.upper_m) / 2
    low, high = grid.lower_m[2], grid.upper_m[2] + 0.4
    if own is not None and own.walls_m is not None:
        low, high = own.walls_m[:, 2]
    lower, upper = (
        (float(x + way * side / 2), float(y + way * side / 2), float(z)) for way, z in ((-1, low), (1, high))
    )
    return FixedRoom.of_entry(RoomEntry(walls=BoxEntry(lower_m=lower, upper_m=upper)), site.path.parent)
