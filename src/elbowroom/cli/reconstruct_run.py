"""The run of `elbowroom reconstruct`: images in, files and a table out."""

import itertools
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from elbowroom.cli.progress import Steps
from elbowroom.cli.room import Room, Scene
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.monitor.rows import shares_pct
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.reconstruct import FreeSpace, reconstruct, warm_up
from elbowroom.site.notes import notes_of
from elbowroom.view import save_npz, save_ply, save_sections
from elbowroom.view.screen.words import NOT_CERTIFIED


def scene_at(room: Room, number: int) -> Scene:
    """A moment of a room by its number.

    Raises:
        InputError: the recording has fewer moments.
    """
    last = -1
    for last, scene in enumerate(itertools.islice(room.scenes(), number + 1)):
        if last == number:
            return scene
    raise InputError(f"--moment: {number} is not there; {room.site.path} has {last + 1} moments, from 0")


def space_of(room: Room, scene: Scene) -> FreeSpace:
    """The free space of a moment."""
    return reconstruct(
        room.grid,
        room.cameras,
        scene.frames,
        machine=room.machine,
        joints=scene.joints if scene.joints_at_frames is None else scene.joints_at_frames,
        rule=room.rule,
        detail=room.detail,
        margin=room.margin,
        now_ns=scene.now_ns if room.site.has_stamps else None,
        max_age_ns=room.site.max_age_ns,
        explain_tolerance_m=room.site.explain_tolerance_m,
    )


def export(room: Room, moment: int, out_dir: Path, json_file: Path | None) -> None:
    """Reconstructs a moment and writes what came of it.

    Raises:
        InputError: the moment is not there, or a file cannot be written.
    """
    folder(out_dir)
    with json_rows(json_file) as add:
        console = Console(stderr=True)
        compile_kernels(
            console,
            machine=room.machine is not None,
            motion=False,
            simulator=room.site.simulated is not None,
        )
        with Steps(console, 6) as steps:
            steps.begin("compiling kernels")
            warm_up(room.machine, [room.detail])
            steps.begin("reading images")
            scene = scene_at(room, moment)
            steps.begin("reconstructing")
            space = space_of(room, scene)
            steps.begin("writing arrays")
            files = [save_npz(out_dir / "free_space.npz", space)]
            steps.begin("writing points")
            files.append(save_ply(out_dir / "blocked.ply", space))
            steps.begin("drawing sections")
            files += save_sections(space, out_dir, room.machine, scene.joints, room.cameras)
        row = _row(room, moment, scene, space, steps.seconds, files)
        add(row)
    _say(row, out_dir)


def _row(
    room: Room, moment: int, scene: Scene, space: FreeSpace, seconds: dict[str, float], files: list[Path]
) -> dict[str, Any]:
    return {
        "site": room.site.name,
        "moment": moment,
        "time_s": scene.now_ns / 1e9 if room.site.has_stamps else None,
        "voxel_size_m": space.grid.voxel_size_m,
        "shape": space.grid.shape,
        "cameras": len(room.cameras),
        "frames": len(scene.frames),
        "rule": room.rule,
        "detail": room.detail,
        **shares_pct(space),
        "joints": scene.joints,
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
    for note in row["notes"]:
        table.add_row("note", note)
    table.add_row(
        "files", f"{len(row['files'])} in {out_dir}: {', '.join(Path(f).name for f in row['files'])}"
    )
    console.print(table)
    console.print(NOT_CERTIFIED, style="dim")
