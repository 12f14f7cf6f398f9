"""`elbowroom bench`: how fast, on this computer."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowroom.cli.options import JsonFile


def bench(
    what: Annotated[
        Literal["cycle", "calibration"],
        typer.Argument(help="cycle: carve and whole cycles; calibration: how well cameras are found."),
    ] = "cycle",
    quick: Annotated[bool, typer.Option(help="Few rounds: a first impression in under a minute.")] = False,
    cameras: Annotated[int, typer.Option(min=1, max=255, help="How many cameras.")] = 21,
    size: Annotated[str, typer.Option(help="Of their images: vga, qqvga or thesis.")] = "vga",
    threads: Annotated[int | None, typer.Option(min=1, help="Default: all cores.")] = None,
    octomap: Annotated[bool, typer.Option(help="Also run OctoMap, where pyoctomap is installed.")] = True,
    captures: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="calibration: keep simulated captures here, and take those that are there."
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            help="calibration: only real, coverage, images, captures, intrinsics, machine, refine or drift; "
            "may be repeated."
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Measure carve and whole cycles in the simulated room, each case in a process of its own; or calibration."""
    if what == "calibration":
        from elbowroom.cli.evaluate.bench_calibration_run import run_bench_calibration

        run_bench_calibration(quick, captures, tuple(part or ()), json)
        return
    from dataclasses import replace

    from rich.console import Console
    from rich.table import Table

    from elbowroom.evaluate.speed.bench import CASES, bench_rows
    from elbowroom.files.json_rows import json_rows

    cases = [replace(case, rounds=5) for case in CASES] if quick else list(CASES)
    table = Table(box=None, pad_edge=False)
    for column in ("case", "voxel", "detail", "noise", "median", "99 %", "worst", "memory", "ratio"):
        left = column in ("case", "detail", "noise")
        table.add_column(column, justify="left" if left else "right", no_wrap=True)
    with json_rows(json) as add, Console(stderr=True).status("rendering the room") as status:
        for row in bench_rows(
            cases, cameras=cameras, size=size, threads=threads, octomap=octomap and not quick
        ):
            add(row)
            status.update(f"{row['case']} at {row['voxel_size_m'] * 100:g} cm, {row['detail']}: done")
            slower = row.get("times_slower_than_carve")
            table.add_row(
                row["case"] + (f" ({slower:.0f} times carve)" if slower else ""),
                f"{row['voxel_size_m'] * 100:g} cm",
                row["detail"],
                "yes" if row["noise"] else "no",
                f"{row['median_ms']:.1f} ms",
                f"{row['p99_ms']:.1f} ms",
                f"{row['max_ms']:.1f} ms",
                "" if row["peak_rss_mb"] is None else f"{row['peak_rss_mb']:.0f} MB",
                "" if row["ratio"] is None else f"{row['ratio']:.2f}",
            )
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 120
    console.print(table)
    console.print("ratio: median over that of a fixed reference kernel in the same process", style="dim")
