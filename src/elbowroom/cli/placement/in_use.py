"""The run of `elbowroom placement optimise --scenes`."""

from pathlib import Path

from rich.console import Console

from elbowroom.cli.placement.optimise import bill_table
from elbowroom.cli.placement.simulate import settings_of
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.bill import bill
from elbowroom.placement.cameras import cameras_of
from elbowroom.placement.candidates import candidates_of
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.in_use import optimise_in_use
from elbowroom.placement.optimisation import Goal
from elbowroom.placement.rehearsal import rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.site import Site
from elbowroom.site.written import write_site

OTHER_SEED = 1000


def run_in_use(
    site_path: Path | None,
    share_pct: float,
    cameras: int | None,
    by_price: bool,
    keep: bool,
    scenes: int,
    seconds: float,
    seed: int,
    write: Path | None,
    json_file: Path | None,
) -> None:
    """Optimises by scenes, rehearses the layout in other scenes, and writes the new site file."""
    site = Site.simulated_room() if site_path is None else Site.load(site_path)
    goal, settings, room = (
        Goal(share_pct, cameras, by_price),
        settings_of(site, None),
        FixedRoom.of_site(site),
    )
    if room is None:
        raise InputError(
            f"{site.path}: room: missing; scenes need walls, or no ray that meets nobody returns"
        )
    candidates = candidates_of(site, settings.grid, room, seed=seed)
    with json_rows(json_file) as add, Console(stderr=True).status("drawing scenes") as status:

        def show(text: str) -> None:
            status.update(text)

        moments = list(random_scenes(site, settings.grid, room, scenes, seed=seed))
        existing = cameras_of(site) if keep else ()
        done = optimise_in_use(
            candidates, moments, settings, goal, existing=existing, seconds=seconds, seed=seed, progress=show
        )
        show("rehearsing in other scenes")
        others = random_scenes(site, settings.grid, room, scenes, seed=seed + OTHER_SEED)
        rehearsed = rehearse(done.cameras, others, settings, seed=seed + OTHER_SEED, by_camera=False)
        if write is not None:
            write_site(site, done.cameras, write)
        add(
            {
                "kind": "layout",
                "site": str(site.path),
                "name": site.name,
                "cameras": len(done.cameras),
                "existing_cameras": len(existing),
                "scenes": scenes,
                "free_pct": rehearsed.free_pct,
                "free_error_pct": rehearsed.free_error_pct,
                "free_in_own_scenes_pct": done.free_pct,
                "bound": done.bound,
                "bound_of": "cameras" if cameras is None else "free_pct",
                "candidates": len(candidates),
                "seconds": done.seconds,
            }
        )
        for item in bill(done.bought):
            add(item)
        for at, count, price, share in done.steps:
            add({"kind": "step", "seconds": at, "cameras": count, "price": price, "free_pct": 100 * share})
    bill_table(done.bought)
    print(f"cameras   {len(done.cameras)}; found in {done.seconds:.0f} s among {len(candidates)} candidates")
    print(
        f"found     {done.free_pct:.2f} % of the free space of its own {scenes} scenes, carved coarsely; "
        f"{rehearsed.free_pct:.2f} % of that of {scenes} others, in full detail"
    )
    bound = f"{done.bound:g} cameras at least" if cameras is None else f"{done.bound:.2f} % at most"
    print(f"bound     {bound} in its own scenes")
    if write is not None:
        print(f"site      {write}")
