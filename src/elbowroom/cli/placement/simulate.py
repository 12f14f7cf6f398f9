"""The run of `elbowroom placement simulate`."""

import time
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.cameras import cameras_of
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.rehearsal import Rehearsal, Settings, rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.site import Site


def run_simulate(
    site_path: Path | None,
    scenes: int,
    people: int,
    table: bool,
    voxel_size_m: float | None,
    by_camera: bool,
    seed: int,
    json_file: Path | None,
) -> None:
    """Carves random scenes of a site and prints what is found of their free space."""
    site = Site.simulated_room() if site_path is None else Site.load(site_path)
    cameras, room = cameras_of(site), FixedRoom.of_site(site)
    if room is None:
        raise InputError(
            f"{site.path}: room: missing; scenes need walls, or no ray that meets nobody returns"
        )
    room.refuse_inside(cameras)
    settings = settings_of(site, voxel_size_m)
    moments = random_scenes(site, settings.grid, room, scenes, people=people, table=table, seed=seed)
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        with Console(stderr=True).status("compiling kernels") as status:

            def show(text: str) -> None:
                status.update(f"{text} of {scenes}")

            done = rehearse(cameras, moments, settings, seed=seed, by_camera=by_camera, progress=show)
        row = _row(site, done, settings, len(cameras), time.perf_counter() - begun)
        add(row)
        for name, (contributes, loss) in done.by_camera().items():
            add({"kind": "camera", "camera": name, "contributes_pct": contributes, "loss_pct": loss})
        for name, (stops, of) in done.false_stops().items():
            add({"kind": "motion", "motion": name, "false_stops": stops, "scenes_without_stop": of})
    _say(row, done)


def settings_of(site: Site, voxel_size_m: float | None) -> Settings:
    """How a site declares space free, with its machine and motions; voxels of another edge unless None [m]."""
    machine = site.machine()
    return Settings(
        site.grid(voxel_size_m),
        site.terms(),
        machine,
        site.motions(machine) if machine is not None else (),
    )


def _row(site: Site, done: Rehearsal, settings: Settings, cameras: int, seconds: float) -> dict[str, Any]:
    """The row of kind "simulate"."""
    stops = done.false_stops().values()
    going = sum(of for _, of in stops)
    return {
        "kind": "simulate",
        "site": str(site.path),
        "name": site.name,
        "scenes": len(done.scenes),
        "cameras": cameras,
        "voxel_size_m": settings.grid.voxel_size_m,
        "rule": settings.terms.rule,
        "detail": settings.terms.detail,
        "free_pct": done.free_pct,
        "free_error_pct": done.free_error_pct,
        "occupied_pct": done.occupied_pct,
        "false_stop_pct": 100.0 * sum(s for s, _ in stops) / going if going else None,
        "judged_motions": going,
        "seconds": seconds,
    }


def _say(row: dict[str, Any], done: Rehearsal) -> None:
    error = f" +- {row['free_error_pct']:.2f}" if row["scenes"] > 1 else ""
    print(
        f"found     {row['free_pct']:.2f}{error} % of the truly free space in {row['scenes']} random scenes; "
        f"{row['cameras']} cameras, {row['voxel_size_m'] * 100:g} cm, rule {row['rule']}, detail {row['detail']}"
    )
    print(f"kept      {row['occupied_pct']:.3f} % of the occupied voxels")
    if row["judged_motions"]:
        print(
            f"stops     {row['false_stop_pct']:.1f} % of {row['judged_motions']} motions stop where the truth would not"
        )
        for name, (stops, of) in done.false_stops().items():
            print(f"          {name}: {stops} of {of}")
    shares = done.by_camera()
    if not shares:
        return
    table = Table(box=None, pad_edge=False)
    for column in ("camera", "contributes", "lost if it fails"):
        table.add_column(column, justify="left" if column == "camera" else "right", no_wrap=True)
    for name, (contributes, loss) in sorted(shares.items(), key=lambda item: -item[1][1]):
        table.add_row(name, f"{contributes:.2f} %", f"{loss:.2f} %")
    shown = Console(highlight=False)
    if not shown.is_terminal:
        shown.width = 120
    shown.print(table)
    shown.print(
        "contributes: what would not be found had it never hung there; lost: if it fails, it disputes all it looks at",
        style="dim",
    )
