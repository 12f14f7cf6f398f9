"""The runs of `elbowroom evaluate`: rows to the file, progress and a table with what is due to the screen."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows

Row = Mapping[str, Any]
Rows = Sequence[Row]
Show = Callable[[Rows], None]
Item = TypeVar("Item")
MOTIONS = 8
"""Four joints of the C-arm in two directions."""


def run_room(voxel_sizes_m: tuple[float, ...], cameras: int, size: str, json: Path | None) -> None:
    """Every detail, with noise and without, against the exact truth."""
    from elbowroom.evaluate.rooms.room import room_rows

    show = _table_of(
        {
            "voxel": _voxel,
            "detail": "{detail}",
            "noise": lambda row: "yes" if row["noise"] else "no",
            "occupied kept": "{occupied_pct:.4f} %",
            "found": "{found_pct:.2f} %",
        },
        "Due with 21 cameras of 640x480: occupied 100.000 % (footprint), 99.99 % (pixel); found "
        "by pixel, above the layer at the floor, 97 % at 2 cm, 94 % at 5 cm; with noise 92 % at 2 cm.",
    )
    rows = room_rows(voxel_sizes_m, cameras=cameras, size=size)
    _run("voxels", rows, 6 * len(voxel_sizes_m), json, show)


def run_sevenscenes(site: Path | None, voxel_sizes_m: tuple[float, ...], json: Path | None) -> None:
    """Every rule and detail against views of the recording that were left out.

    Raises:
        InputError: no site given, and none in a checkout; or what reading the site raises.
    """
    from elbowroom.evaluate.rooms.sevenscenes import sevenscenes_rows

    show = _table_of(
        {
            "voxel": _voxel,
            "margin": "{margin}",
            "detail": "{detail}",
            "rule": "{rule}",
            "free": "{free_pct:.2f} %",
            "false": "{false_pct:.3f} %",
        },
        "Due at 5 cm, false at most 0.30 %: free 10 % by a lawful rule, 16 % by veto, 20 % by any rule.",
    )
    rows = sevenscenes_rows(site or example_site(), voxel_sizes_m)
    _run("rules and details", rows, 24 * len(voxel_sizes_m), json, show)


def run_alone(
    voxel_sizes_m: tuple[float, ...], poses: int, cameras: int, size: str, seed: int, json: Path | None
) -> None:
    """The C-arm alone in the room."""
    from elbowroom.evaluate.rooms.alone import alone_rows, alone_summary

    counts = ("poses", "verdicts", "clear", "inform", "decelerate", "stop")
    show = _table_of({"voxel": _voxel, **{name: f"{{{name}}}" for name in counts}, "due": "all clear"})
    rows = alone_rows(voxel_sizes_m, poses=poses, cameras=cameras, size=size, seed=seed)
    _run("verdicts", rows, MOTIONS * poses * len(voxel_sizes_m), json, show, alone_summary)


def run_poses(voxel_size_m: float, poses: int, cameras: int, size: str, seed: int, json: Path | None) -> None:
    """Verdicts beside exact geometry's.

    Raises:
        ElbowroomError: coal is not installed.
    """
    from elbowroom.evaluate.rooms.poses import poses_rows, poses_summary

    show = _figures(
        ("poses", "poses", "{}", ""),
        ("verdicts", "verdicts", "{}", ""),
        ("milder than exact geometry", "milder", "{}", "0"),
        ("truly clear over the whole reach", "truly_clear", "{}", ""),
        ("of these stop", "stop_where_clear_pct", "{:.1f} %", "10 % at most"),
        ("of these clear", "clear_where_clear_pct", "{:.1f} %", ""),
        ("same level as exact geometry", "same_level_pct", "{:.1f} %", ""),
    )
    rows = poses_rows(voxel_size_m, poses=poses, cameras=cameras, size=size, seed=seed)
    _run("verdicts", rows, MOTIONS * poses, json, show, lambda rows: [poses_summary(rows)])


def run_travel(voxel_size_m: float, poses: int, seed: int, json: Path | None) -> None:
    """Free travel in the true volume beside exact mesh distance.

    Raises:
        ElbowroomError: coal is not installed.
    """
    from elbowroom.evaluate.rooms.travel import travel_rows, travel_summary

    show = _figures(
        ("poses", "poses", "{}", ""),
        ("motions", "motions", "{}", ""),
        ("more travel than the truth", "more_than_truth", "{}", "0"),
        ("motions that touch something", "touching", "{}", ""),
        ("median shortfall of these", "median_shortfall_voxels", "{:.2f} voxels", "1.5 voxels at most"),
        ("greatest shortfall", "greatest_shortfall_voxels", "{:.2f} voxels", ""),
    )
    rows = travel_rows(voxel_size_m, poses=poses, seed=seed)
    _run("motions", rows, MOTIONS * poses, json, show, lambda rows: [travel_summary(rows)])


def example_site() -> Path:
    """examples/sevenscenes.yaml of the checkout that this code runs from.

    Raises:
        InputError: it does not run from a checkout.
    """
    path = Path(__file__).resolve().parents[4] / "examples" / "sevenscenes.yaml"
    if not path.is_file():
        raise InputError(f"SITE: needed, there is no {path.name} beside this installation; name a site file")
    return path


def _run(
    what: str,
    found: Iterable[Row],
    total: int,
    json: Path | None,
    show: Show,
    summary: Callable[[Rows], Rows] | None = None,
) -> None:
    """Writes rows and their summary, then shows the summary, or else the rows.

    Where there is a summary, rows leave out what it says. After Ctrl-C: shows what there is, no file.
    """
    from elbowroom.evaluate.rooms.scene import lean

    rows: list[Row] = []
    try:
        with json_rows(json) as add:
            for row in watched(what, found, total):
                add(lean(row) if summary else row)
                rows.append(row)
            shown = summary(rows) if summary else rows
            for row in shown if summary else ():
                add(row)
    except KeyboardInterrupt:
        if rows:
            show(summary(rows) if summary else rows)
            _print(f"Interrupted after {len(rows)} of {total} {what}; no file was written.")
        raise
    show(shown)


def watched(what: str, rows: Iterable[Item], total: int) -> Iterable[Item]:
    """The rows, with a bar on a terminal."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        yield from progress.track(rows, total=total, description=what)


def _table_of(columns: Mapping[str, str | Callable[[Row], str]], due: str = "") -> Show:
    """Shows a line for each row, then what is due; a cell is a format of the row's values, or a function."""

    def show(rows: Rows) -> None:
        table = _table(*columns)
        for row in rows:
            cells = columns.values()
            table.add_row(*(cell.format(**row) if isinstance(cell, str) else cell(row) for cell in cells))
        _print(table)
        if due:
            _print(due)

    return show


def _figures(*figures: tuple[str, str, str, str]) -> Show:
    """Shows a line for each figure of one summary: its words, its key, how it is written, what is due."""

    def show(rows: Rows) -> None:
        (summary,) = rows
        table = _table("figure", "measured", "due")
        for words, key, how, due in figures:
            table.add_row(words, "-" if summary[key] is None else how.format(summary[key]), due)
        _print(table)

    return show


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False)
    words = ("detail", "noise", "margin", "rule", "figure", "due")
    for column in columns:
        table.add_column(column, justify="left" if column in words else "right")
    return table


def _print(what: Table | str) -> None:
    Console(highlight=False).print(what)


def _voxel(row: Row) -> str:
    return f"{row['voxel_size_m'] * 100:g} cm"
