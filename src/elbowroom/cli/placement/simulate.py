"""The run of `elbowroom placement simulate`."""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.options import options_named
from elbowroom.cli.placement.options import SimulateOptions
from elbowroom.cli.placement.room import room_of
from elbowroom.cli.screen import note, show
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.rehearsal import Rehearsal, Settings, rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.site import Site
from elbowroom.sources import cameras_of
from elbowroom.view.report.blocks import Table

WORTH = "contributes: what would not be found had it never hung there; lost: if it fails, it disputes all it looks at"


def run_simulate(options: SimulateOptions, json_file: Path | None) -> None:
    """Carves random scenes of a site and prints what is found of their free space.

    Raises:
        InputError: a site without walls, a camera inside something, or a scene that has no place for its people.
    """
    site = Site.simulated_room() if options.site is None else Site.load(options.site)
    cameras, room = cameras_of(site), walled_room(site)
    room.refuse_inside(cameras)
    settings = Settings.of_site(site, options.voxel_size_m)
    moments = random_scenes(
        site,
        settings.grid,
        room,
        options.scenes,
        people=options.people,
        table=options.table,
        seed=options.seed,
    )
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        status = Console(stderr=True).status("readying kernels, which are compiled at the first start")
        with status, options_named(people="--people", table="--table"):
            done = rehearse(
                cameras,
                moments,
                settings,
                seed=options.seed,
                by_camera=options.by_camera,
                progress=lambda text: status.update(f"{text} of {options.scenes}"),
            )
        row = done.row() | _of_site(site, settings, len(cameras), time.perf_counter() - begun)
        for each in (row, *done.part_rows()):
            add(each)
    _say(row, done)


def walled_room(site: Site) -> FixedRoom:
    """The fixed room of a site.

    Raises:
        InputError: it says nothing of one.
    """
    room = room_of(site)
    if room is None:
        raise InputError(
            f"{site.path}: room: missing; scenes need walls, or no ray that meets nobody returns"
        )
    return room


def worth_table(by_camera: Mapping[str, tuple[float, float]]) -> Table:
    """What each camera is worth, the most needed first.

    Args:
        by_camera: what it contributes, and what is lost if it fails [%].
    """
    most_lost = sorted(by_camera.items(), key=lambda item: -item[1][1])
    lines = [(name, f"{contributes:.2f} %", f"{loss:.2f} %") for name, (contributes, loss) in most_lost]
    return Table("", ("camera", "contributes", "lost if it fails"), lines)


def _of_site(site: Site, settings: Settings, cameras: int, seconds: float) -> dict[str, Any]:
    return {
        "site": str(site.path),
        "name": site.name,
        "cameras": cameras,
        "voxel_size_m": settings.grid.voxel_size_m,
        "rule": settings.terms.rule,
        "detail": settings.terms.detail,
        "seconds": seconds,
    }


def _say(row: Mapping[str, Any], done: Rehearsal) -> None:
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
    if done.by_camera():
        show(worth_table(done.by_camera()))
        note(WORTH)
