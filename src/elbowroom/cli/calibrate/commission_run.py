"""The run of `elbowroom calibrate commission`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from elbowroom.cli.options import options_named
from elbowroom.cli.screen import show
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.finding import Finding
from elbowroom.monitor import Tolerance
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.site_file import write_commissioned
from elbowroom.reconstruct.model_findings import model_findings
from elbowroom.sensing import Snapshot
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.layouts.layout import layout_of
from elbowroom.view.report.blocks import Table


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
    with options_named(joints="--joints"):
        room = open_room(site, joints=joints)
        wanted, given = _moments(room, frames, every_s)
    commissioning = Commissioning(room.cameras, room.machine, wanted)
    doubts: tuple[Finding, ...] | None = None
    with json_rows(json_file) as add:
        for snapshot in track(given, "looking", total=wanted, console=Console(stderr=True), transient=True):
            commissioning.add(snapshot)
            if room.machine is not None and doubts is None:
                doubts = model_findings(room.machine, room.cameras, snapshot)
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
        for doubt in doubts or ():
            add({"kind": "finding", **asdict(doubt)})
    show(reference_table(rows))
    for doubt in doubts or ():
        print(f"note: {doubt.text}")
    print(f"{written} and {beside.name}: try `elbowroom monitor {written}`")


def _moments(room: Room, frames: int, every_s: float) -> tuple[int, Iterator[Snapshot]]:
    """How many moments there will be, and each: of the simulated room, or evenly of a recording."""
    if room.site.simulated is not None:
        from elbowroom.sources.simulated import Simulated

        assert isinstance(room.source, Simulated)
        return frames, room.source.at(number * every_s for number in range(frames))
    total = len(layout_of(room.site).moments())
    if total < 5:
        raise CalibrationError(
            f"{room.site.path}: a recording of {total} moments, at least 5 are needed to see what stands still"
        )
    chosen = set(np.unique(np.linspace(0, total - 1, min(frames, total)).round().astype(int)).tolist())
    return len(chosen), (moment for number, moment in enumerate(room.source) if number in chosen)


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
