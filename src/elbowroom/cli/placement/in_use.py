"""The run of `elbowroom placement optimise --scenes`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.placement.options import OptimiseOptions
from elbowroom.cli.placement.simulate import walled_room
from elbowroom.cli.screen import show
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.bill import bill, bill_table
from elbowroom.placement.candidates import Candidate, candidates_of
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.in_use import FoundInUse, optimise_in_use
from elbowroom.placement.optimisation import Goal, Search
from elbowroom.placement.rehearsal import Rehearsal, Settings, rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.simulate import Moment
from elbowroom.site import Site
from elbowroom.site.written import write_site
from elbowroom.sources import cameras_of

OTHER_SEED = 1000


def run_in_use(options: OptimiseOptions, json_file: Path | None) -> None:
    """Optimises by scenes, rehearses the layout in other scenes, and writes the new site file.

    Raises:
        InputError: a site without walls, or a goal that cannot be; see `optimise_in_use`.
    """
    site = Site.simulated_room() if options.site is None else Site.load(options.site)
    goal = Goal(options.share_pct, options.cameras, options.by_price, options.motions)
    settings, room = Settings.of_site(site), walled_room(site)
    candidates = candidates_of(site, settings.grid, room, seed=options.seed)
    with json_rows(json_file) as add:
        done, rehearsed, before = _optimised(site, room, goal, candidates, settings, options)
        if options.write is not None:
            write_site(site, done.cameras, options.write)
        row = {
            "kind": "layout",
            "site": str(site.path),
            "name": site.name,
            "existing_cameras": len(done.cameras) - len(done.bought),
            "candidates": len(candidates),
            "bound_of": "cameras" if goal.cameras is None else "free_pct",
            "by_motions": goal.by_motions,
            **_found(done, rehearsed),
            **_stops(rehearsed, before),
        }
        items = bill(done.bought)
        for each in (row, *items, *done.step_rows()):
            add(each)
    show(bill_table(items))
    _say(row)
    if options.write is not None:
        print(f"site      {options.write}")


def _optimised(
    site: Site,
    room: FixedRoom,
    goal: Goal,
    candidates: Sequence[Candidate],
    settings: Settings,
    options: OptimiseOptions,
) -> tuple[FoundInUse, Rehearsal, Rehearsal | None]:
    """The layout, what it finds in other scenes, and what the site's own cameras find there."""
    seed = options.seed

    def scenes(of_seed: int) -> list[Moment]:
        count, people, table = options.scenes, options.people, options.table
        drawn = random_scenes(site, settings.grid, room, count, people=people, table=table, seed=of_seed)
        return list(drawn)

    status = Console(stderr=True).status("drawing scenes")
    with status, asked_to_end("the best layout so far is verified and written") as stop:
        done = optimise_in_use(
            candidates,
            scenes(seed),
            settings,
            goal,
            existing=cameras_of(site) if options.keep else (),
            search=Search(options.seconds, seed=seed, stop=stop),
            progress=lambda text: status.update(text),
        )
        status.update("rehearsing in other scenes")
        seed += OTHER_SEED
        others, before = scenes(seed), None
        after = rehearse(done.cameras, others, settings, seed=seed, by_camera=False)
        own = cameras_of(site) if site.lists_cameras or site.simulated is not None else ()
        if own and goal.by_motions:
            status.update("rehearsing the site's own cameras")
            before = rehearse(own, others, settings, seed=seed, by_camera=False)
        return done, after, before


def _found(done: FoundInUse, rehearsed: Rehearsal) -> dict[str, Any]:
    names = ("scenes", "free_pct", "free_error_pct")
    return done.row() | {name: value for name, value in rehearsed.row().items() if name in names}


def _stops(after: Rehearsal, before: Rehearsal | None) -> dict[str, Any]:
    """Motions stopped for nothing in the other scenes, with the new cameras and with the site's own."""
    row = {name: after.row()[name] for name in ("false_stop_pct", "judged_motions")}
    return row | {"false_stop_before_pct": None if before is None else before.row()["false_stop_pct"]}


def _say(row: Mapping[str, Any]) -> None:
    print(f"cameras   {row['cameras']}; found in {row['seconds']:.0f} s among {row['candidates']} candidates")
    what = "what the motions sweep in" if row["by_motions"] else "the free space of"
    print(
        f"found     {row['free_in_own_scenes_pct']:.2f} % of {what} its own {row['scenes']} scenes, carved "
        f"coarsely; {row['free_pct']:.2f} % of the free space of {row['scenes']} others, in full detail"
    )
    if row["by_motions"] and row["false_stop_pct"] is not None:
        before = row["false_stop_before_pct"]
        now = "" if before is None else f", and with the site's own cameras {before:.1f} %"
        print(
            f"stops     {row['false_stop_pct']:.1f} % of {row['judged_motions']} motions that may go are stopped in "
            f"these others{now}"
        )
    of_cameras = row["bound_of"] == "cameras"
    bound = f"{row['bound']:g} cameras at least" if of_cameras else f"{row['bound']:.2f} % at most"
    print(f"bound     {bound} in its own scenes")
