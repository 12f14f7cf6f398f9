"""The run of `elbowroom placement optimise`."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.placement.options import OptimiseOptions
from elbowroom.cli.placement.room import room_of
from elbowroom.cli.placement.verify import say_files, say_verification, verified_row
from elbowroom.cli.screen import show
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.bill import bill, bill_table
from elbowroom.placement.candidates import candidates_of
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.optimisation import Goal, Optimised, Search, optimise
from elbowroom.placement.pictures import save_pictures
from elbowroom.placement.requirement import requirement_of
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from elbowroom.site.written import write_site
from elbowroom.sources import cameras_of


def run_optimise(options: OptimiseOptions, json_file: Path | None) -> None:
    """Optimises, prints the layout and what it costs, and writes the new site file.

    Raises:
        InputError: a site, a goal or a time that cannot be; see `optimise`.
    """
    if not options.seconds > 0 or not math.isfinite(options.seconds):
        raise InputError(f"--seconds: {options.seconds:g}, must be above 0")
    site = Site.load(THESIS_ROOM if options.site is None else options.site)
    goal = Goal(options.share_pct, options.cameras, options.by_price)
    room = room_of(site)
    with json_rows(json_file) as add:
        done = _optimised(site, room, goal, options)
        row = verified_row(done.found) | _layout(site, goal, len(done.cameras) - len(done.bought))
        row |= done.row() | {"walls_known": room is not None}
        files = [] if options.out is None else save_pictures(done.found, room, options.out, site.name)
        if options.write is not None:
            files.append(write_site(site, done.cameras, options.write))
        items = bill(done.bought)
        for each in (row | {"files": [str(path) for path in files]}, *items, *done.step_rows()):
            add(each)
    show(bill_table(items))
    _say(row)
    say_verification(row)
    say_files(files, walls_known=room is not None, site=options.write)


def _optimised(site: Site, room: FixedRoom | None, goal: Goal, options: OptimiseOptions) -> Optimised:
    grid = site.grid()
    status = Console(stderr=True).status("")
    with status, asked_to_end("the best layout so far is verified and written") as stop:
        return optimise(
            grid,
            room,
            candidates_of(site, grid, room, seed=options.seed),
            requirement_of(site, options.required.views, options.required.angle_deg),
            goal,
            existing=cameras_of(site) if options.keep else (),
            search=Search(options.seconds, options.points, options.seed, stop),
            progress=lambda text: status.update(text),
        )


def _layout(site: Site, goal: Goal, existing: int) -> dict[str, Any]:
    """What a row of kind "layout" says of the task."""
    return {
        "kind": "layout",
        "site": str(site.path),
        "name": site.name,
        "wanted_share_pct": None if goal.cameras is not None else goal.share_pct,
        "existing_cameras": existing,
        "bound_of": goal.bound_of,
    }


def _say(row: Mapping[str, Any]) -> None:
    kept = f", {row['existing_cameras']} of them there already" if row["existing_cameras"] else ""
    print(
        f"cameras   {row['cameras']}{kept}; found in {row['seconds']:.0f} s among {row['candidates']} candidates"
    )
    with_share = "no layout of these candidates with this share of the solver's points valid"
    bound = {
        "cameras": f"{with_share} has fewer than {row['bound']:g} cameras",
        "price": f"{with_share} costs less than {row['bound']:.2f}",
        "valid_pct": f"no layout of so many of these candidates has more than {row['bound']:.2f} % of the points valid",
    }
    print(f"bound     {bound[row['bound_of']]}")
    if row["sector_bound"] is not None and row["sector_bound"] > row["bound"]:
        unit = {"cameras": "cameras", "price": "price", "valid_pct": "%"}[row["bound_of"]]
        print(
            f"          by sectors at CP-SAT's few points: {row['sector_bound']:.4g} {unit} (no proof for all layouts)"
        )
