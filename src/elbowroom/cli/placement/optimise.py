"""The run of `elbowroom placement optimise`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from elbowroom.cli.placement.run import NO_WALLS, say_verification, verification_row
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.bill import bill
from elbowroom.placement.cameras import cameras_of, requirement_of
from elbowroom.placement.candidates import Candidate, candidates_of
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.optimisation import Goal, Optimised, Search, optimise
from elbowroom.placement.pictures import save_pictures
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from elbowroom.site.written import write_site


def run_optimise(
    site_path: Path | None,
    share_pct: float,
    cameras: int | None,
    by_price: bool,
    keep: bool,
    seconds: float,
    points: int,
    views: int | None,
    angle_deg: float | None,
    seed: int,
    write: Path | None,
    out: Path | None,
    json_file: Path | None,
) -> None:
    """Optimises, prints the layout and what it costs, and writes the new site file."""
    if not seconds > 0 or not math.isfinite(seconds):
        raise InputError(f"--seconds: {seconds:g}, must be above 0")
    site = Site.load(THESIS_ROOM if site_path is None else site_path)
    requirement, goal = requirement_of(site, views, angle_deg), Goal(share_pct, cameras, by_price)
    room, grid = FixedRoom.of_site(site), site.grid()
    candidates = candidates_of(site, grid, room, seed=seed)
    existing = cameras_of(site) if keep else ()
    with json_rows(json_file) as add:
        console = Console(stderr=True)
        with console.status("") as status:

            def show(text: str) -> None:
                status.update(text)

            done = optimise(
                grid,
                room,
                candidates,
                requirement,
                goal,
                existing=existing,
                search=Search(seconds, points, seed),
                progress=show,
            )
        row = _row(done, site, goal, len(existing)) | {"walls_known": room is not None}
        files = [] if out is None else save_pictures(done.found, room, out, site.name)
        if write is not None:
            files.append(write_site(site, done.cameras, write))
        add(row | {"files": [str(path) for path in files]})
        for item in bill(done.bought):
            add(item)
        for at, count, price, share in done.steps:
            add({"kind": "step", "seconds": at, "cameras": count, "price": price, "valid_pct": 100 * share})
    _say(done, row)
    if room is None:
        print(f"note      {NO_WALLS}")
    for path in files:
        print(f"{'site' if path == write else 'picture':9} {path}")


def _row(done: Optimised, site: Site, goal: Goal, existing: int) -> dict[str, Any]:
    """The row of kind "layout"."""
    verified = verification_row(done.found)
    bound_of = "valid_pct" if goal.cameras is not None else "price" if goal.by_price else "cameras"
    return verified | {
        "kind": "layout",
        "site": str(site.path),
        "name": site.name,
        "wanted_share_pct": None if goal.cameras is not None else goal.share_pct,
        "existing_cameras": existing,
        "bound": done.bound,
        "bound_of": bound_of,
        "sector_bound": done.sector_bound,
        "price": done.price,
        "model_valid_pct": done.model_pct,
        "solver_points": done.points,
        "candidates": done.candidates,
        "seconds": done.seconds,
    }


def bill_table(bought: Sequence[Candidate]) -> None:
    """Prints what each camera costs."""
    table = Table(box=None, pad_edge=False)
    for column in ("camera", "x, y, z in m", "kind", "sensor", "mount", "cable", "price"):
        left = column in ("camera", "x, y, z in m", "kind")
        table.add_column(column, justify="left" if left else "right", no_wrap=True)
    for item in bill(bought):
        total = item["kind"] == "total"
        table.add_row(
            "all" if total else item["camera"],
            "" if total else ", ".join(f"{v + 0.0:.2f}" for v in item["position_m"]),
            "" if total else item["sensor"],
            f"{item['sensor_price']:g}",
            f"{item['mount_price']:g}",
            f"{item['cable_m']:.1f} m {item['cable_price']:.2f}",
            f"{item['price']:.2f}",
        )
    shown = Console(highlight=False)
    if not shown.is_terminal:
        shown.width = 120
    shown.print(table)


def _say(done: Optimised, row: dict[str, Any]) -> None:
    bill_table(done.bought)
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
    say_verification(row)
