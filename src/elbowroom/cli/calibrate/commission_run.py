"""The run of `elbowroom calibrate commission`."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from elbowroom.cli.room import open_room
from elbowroom.cli.screen import show
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.monitor import Tolerance
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.site_file import write_commissioned
from elbowroom.sensing import DepthFrame
from elbowroom.site import Site
from elbowroom.sources import moments
from elbowroom.sources.images import image_groups
from elbowroom.view.report.blocks import Table

Moment = tuple[Sequence[DepthFrame], Mapping[str, float] | None]


def run_commission(
    path: Path | None,
    out: Path,
    frames: int,
    every_s: float,
    joints: Mapping[str, float] | None,
    json_file: Path | None,
) -> None:
    """Commissions a site and says what each camera's reference shows.

    Args:
        path: of the site; None: the simulated room.
        out: the new site file.
        frames: how many moments.
        every_s: between them, in a simulated room [s].
        joints: positions that hold throughout [m or rad]; None: the room's own.
        json_file: where rows go; None: nowhere.

    Raises:
        InputError: a site, a recording or a file that is not usable, or too little that stands still.
    """
    site = Site.simulated_room() if path is None else Site.load(path)
    room = open_room(site, joints=joints)
    wanted, given = _moments(site, joints, frames, every_s)
    commissioning = Commissioning(room.cameras, room.machine, wanted)
    with json_rows(json_file) as add:
        for seen, positions in track(
            given, "looking", total=wanted, console=Console(stderr=True), transient=True
        ):
            commissioning.add(seen, positions)
        references = [
            commissioning.reference_of(camera)
            for camera in track(
                room.cameras, "what stands still", console=Console(stderr=True), transient=True
            )
        ]
        written, beside = write_commissioned(site, references, out)
        rows = [reference.row(Tolerance()) for reference in references]
        for row in rows:
            add(row)
    show(reference_table(rows))
    print(f"{written} and {beside.name}: try `elbowroom monitor {written}`")


def _moments(
    site: Site, joints: Mapping[str, float] | None, frames: int, every_s: float
) -> tuple[int, Iterator[Moment]]:
    """How many moments there will be, and each: of the simulated room, or evenly of a recording."""
    if site.simulated is not None:
        return frames, _simulated(site, joints, frames, every_s)
    total = len(image_groups(site))
    if total < 5:
        raise CalibrationError(
            f"{site.path}: a recording of {total} moments, at least 5 are needed to see what stands still"
        )
    chosen = set(np.unique(np.linspace(0, total - 1, min(frames, total)).round().astype(int)).tolist())
    recorded = (
        (moment.frames, moment.joints)
        for number, moment in enumerate(moments(site, joints))
        if number in chosen
    )
    return len(chosen), recorded


def _simulated(
    site: Site, joints: Mapping[str, float] | None, frames: int, every_s: float
) -> Iterator[Moment]:
    from elbowroom.simulate import InterventionRoom, render

    assert site.simulated is not None
    room, opened = InterventionRoom(machine=site.machine()), open_room(site)
    for number in range(frames):
        moment = room.at(number * every_s, joints=joints)
        yield render(opened.cameras, moment, seed=site.simulated.seed + number), moment.joints


def reference_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """What each camera's reference shows, a line a camera.

    Args:
        rows: of kind "reference".
    """
    lines = []
    for row in rows:
        near, far = row["range_m"]
        lines.append(
            (
                row["camera"],
                str(row["spots"]),
                f"{near:.1f} to {far:.1f} m",
                f"{max(row['turn_sigma_deg']):.2f}°",
                f"{max(row['move_sigma_mm']):.1f} mm",
                ", ".join(row["not_shown"]) or "-",
            )
        )
    columns = ("camera", "spots", "range", "turn told to", "move told to", "not shown by what it sees")
    return Table("", columns, lines, left=(0, 5))
