"""The run of `elbowroom calibrate commission`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from elbowroom.cli.calibrate.result import refuse
from elbowroom.cli.options import options_named
from elbowroom.cli.screen import show
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.finding import Finding
from elbowroom.geometry.twist import CAMERA_MOTIONS
from elbowroom.monitor import CameraReference
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.site_file import write_commissioned
from elbowroom.monitor.start.watching import tolerance_of
from elbowroom.reconstruct.looking import found_at
from elbowroom.reconstruct.model_findings import model_findings
from elbowroom.sensing import Snapshot
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.layouts.layout import layout_of
from elbowroom.sources.looked import units_of
from elbowroom.view.report.blocks import Table


@dataclass(frozen=True, slots=True)
class CommissionOptions:
    """What the command line says; see its help.

    Args:
        path: of the site; None: the simulated room.
        out: the new site file.
        frames: how many moments.
        every_s: between them, in a simulated room [s].
        joints: positions that hold throughout [m or rad]; None: the room's own.
        force_file: what is no result is written all the same, under another name.
    """

    path: Path | None
    out: Path
    frames: int
    every_s: float
    joints: Mapping[str, float] | None
    force_file: bool


def run_commission(options: CommissionOptions, json_file: Path | None) -> None:
    """Commissions a site and says what each camera's reference shows.

    Raises:
        InputError: a site, a recording or a file that is not usable, or too little that stands still.
        NoResultError: images or poses that cannot be meant so, or a camera whose view tells nothing; no file of the
            name that was asked for is written.
    """
    site = Site.simulated_room() if options.path is None else Site.load(options.path)
    with options_named(joints="--joints"):
        room = open_room(site, joints=options.joints)
        wanted, given = _moments(room, options.frames, options.every_s)
    if room.terms.without_machine:
        raise CalibrationError(
            f"{site.path}: the machine stood in none of the images (recording.without_machine); commission the room as "
            "it is watched, with the machine"
        )
    commissioning, found = Commissioning(room.cameras, room.machine, wanted), _Found(room)
    with json_rows(json_file) as add:
        for snapshot in track(given, "looking", total=wanted, console=Console(stderr=True), transient=True):
            commissioning.add(snapshot)
            found.look(snapshot)
            if found.stops and not options.force_file:
                refuse(found.stops, options.out, _nothing_yet, force_file=False)
        references = [
            commissioning.reference_of(camera)
            for camera in track(
                room.cameras, "what stands still", console=Console(stderr=True), transient=True
            )
        ]
        tolerance = tolerance_of(site)
        rows = [reference.row(tolerance) for reference in references]
        for row in rows:
            add(row)
        for finding in found.findings:
            add({"kind": "finding", **asdict(finding)})
    show(reference_table(rows))
    for finding in found.findings:
        print(f"note: {finding.text}")
    doubts = (*found.stops, *that_tell_nothing(rows))
    if doubts:
        write = partial(_written_aside, site, references)
        refuse(doubts, options.out, write, force_file=options.force_file)
    written, beside = write_commissioned(site, references, options.out)
    print(f"{written} and {beside.name}: try `elbowroom monitor {written}`")


@dataclass(slots=True)
class _Found:
    """What is found of the first moment that has images: in its values, and of the machine's model."""

    room: Room
    findings: tuple[Finding, ...] = ()
    looked: bool = False

    def look(self, snapshot: Snapshot) -> None:
        if self.looked or not snapshot.frames:
            return
        room, self.looked = self.room, True
        units_m = units_of(room.site, room.cameras)
        self.findings = found_at(room.grid, room.cameras, snapshot.frames, units_m, room.terms.margin)
        if room.machine is not None:
            self.findings += model_findings(room.machine, room.cameras, snapshot)

    @property
    def stops(self) -> tuple[str, ...]:
        return tuple(finding.text for finding in self.findings if finding.stops)


def that_tell_nothing(rows: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """A sentence for each camera of which no motion could be noticed, whichever it is.

    Args:
        rows: of kind "reference".
    """
    blind = [row for row in rows if len(row["not_shown"]) == len(CAMERA_MOTIONS)]
    return tuple(
        f"{row['camera']} could be moved in any way and nobody would notice: one frame tells a turn to "
        f"{max(row['turn_sigma_deg']):.1f} degrees and a move to {max(row['move_sigma_mm']):.0f} mm; give it a view of "
        "floor and walls, nearer, or a larger turn_deg and move_mm"
        for row in blind
    )


def _written_aside(site: Site, references: Sequence[CameraReference], aside: Path) -> Path:
    return write_commissioned(site, references, aside)[0]


def _nothing_yet(aside: Path) -> Path:
    return aside


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
