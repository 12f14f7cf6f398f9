"""The run of `elbowroom reconstruct`: images in, files and a table out."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from elbowroom.cli.progress import Steps
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.finding import Finding
from elbowroom.monitor.rows import shares_pct
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.reconstruct import FreeSpace, warm_up
from elbowroom.reconstruct.looking import found_at, found_in_space, refuse
from elbowroom.reconstruct.machine_there import machine_there
from elbowroom.sensing import Snapshot
from elbowroom.site.notes import notes_of
from elbowroom.sources import Room
from elbowroom.sources.looked import units_of
from elbowroom.view import save_npz, save_ply, save_sections
from elbowroom.view.screen.words import NOT_CERTIFIED


def export(room: Room, moment: int, out_dir: Path, json_file: Path | None) -> None:
    """Reconstructs a moment and writes what came of it.

    Args:
        room: of the moment.
        moment: its number, from 0.
        out_dir: where files go; made if it is not there.
        json_file: where the row goes; None: nowhere.

    Raises:
        InputError: the moment is not there, or a file cannot be written.
    """
    folder(out_dir)
    with json_rows(json_file) as add:
        console = Console(stderr=True)
        simulated = room.site.simulated is not None
        if not simulated:
            # before anything is compiled: what is missing is said at once
            room.site.recording_folder()
        compile_kernels(console, machine=room.machine is not None, motion=False, simulator=simulated)
        with Steps(console, 6) as steps:
            steps.begin("loading kernels")
            warm_up(room.machine, [room.terms.detail])
            steps.begin("reading images")
            snapshot = room.snapshot(moment)
            units_m = units_of(room.site, room.cameras)
            findings = found_at(room.grid, room.cameras, snapshot.frames, units_m, room.terms.margin)
            if room.machine is not None:
                is_absent = room.terms.without_machine
                there = machine_there(room.machine, room.cameras, snapshot, is_absent=is_absent)
                findings = (*findings, *there)
            refuse(findings)
            steps.begin("reconstructing")
            space = room.space_of(snapshot)
            findings = (*findings, *found_in_space(space), *_nothing_free(space))
            steps.begin("writing arrays")
            files = [save_npz(out_dir / "free_space.npz", space)]
            steps.begin("writing points")
            files.append(save_ply(out_dir / "blocked.ply", space))
            steps.begin("drawing sections")
            machine = room.machine if snapshot.joints is not None else None
            files += save_sections(space, out_dir, machine, snapshot.joints, room.cameras)
        row = _row(room, moment, snapshot, space, steps.seconds, files)
        row["findings"] = [asdict(finding) for finding in findings]
        add(row)
    _say(row, out_dir)


def _nothing_free(space: FreeSpace) -> tuple[Finding, ...]:
    """That nothing is free but the machine's own body, with where to look."""
    if (space.free_words & ~space.body_words).any():
        return ()
    shares = shares_pct(space)
    text = (
        f"nothing is free: {shares['surface_pct']:.1f} % is surface, {shares['blind_pct']:.1f} % blind, and no camera "
        "sees through the rest, or others dispute it. Check that cameras look into the grid (elbowroom site check "
        "--out room.png), units and frames of their poses, and whether images are mostly without returns"
    )
    return (Finding("nothing free", (), text, stops=False),)


def _row(
    room: Room,
    moment: int,
    snapshot: Snapshot,
    space: FreeSpace,
    seconds: dict[str, float],
    files: list[Path],
) -> dict[str, Any]:
    return {
        "site": room.site.name,
        "moment": moment,
        "time_s": None if snapshot.now_ns is None else snapshot.now_ns / 1e9,
        "voxel_size_m": space.grid.voxel_size_m,
        "shape": space.grid.shape,
        "cameras": len(room.cameras),
        "frames": len(snapshot.frames),
        "rule": room.terms.rule,
        "detail": room.terms.detail,
        **shares_pct(space),
        "joints": snapshot.joints,
        "read_ms": seconds["reading images"] * 1e3,
        "reconstruct_ms": seconds["reconstructing"] * 1e3,
        "files": [str(path) for path in files],
        "notes": list(notes_of(room.site)),
    }


def _say(row: dict[str, Any], out_dir: Path) -> None:
    console = Console(highlight=False)
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="dim")
    table.add_column(overflow="fold")
    counts = " x ".join(map(str, row["shape"]))
    table.add_row("room", f"{row['site']}, {counts} voxels of {row['voxel_size_m'] * 100:g} cm")
    table.add_row("images", f"{row['frames']} of {row['cameras']} cameras, read in {row['read_ms']:.0f} ms")
    table.add_row(
        "decided by", f"rule {row['rule']}, detail {row['detail']}, in {row['reconstruct_ms']:.0f} ms"
    )
    table.add_row("free", f"{row['free_pct']:.2f} %")
    table.add_row("surface", f"{row['surface_pct']:.2f} %")
    table.add_row("unseen", f"{row['unseen_pct']:.2f} %")
    table.add_row(
        "of which blind", f"{row['blind_pct']:.2f} % of all: a camera that looks there gave nothing valid"
    )
    table.add_row("own body", f"{row['body_pct']:.2f} % of all")
    for note in (*row["notes"], *(finding["text"] for finding in row["findings"])):
        table.add_row("note", note)
    table.add_row(
        "files", f"{len(row['files'])} in {out_dir}: {', '.join(Path(f).name for f in row['files'])}"
    )
    console.print(table)
    console.print(NOT_CERTIFIED, style="dim")
