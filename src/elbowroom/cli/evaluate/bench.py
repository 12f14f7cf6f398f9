"""`elbowroom bench`: how fast, on this computer."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowroom.cli.options import JsonFile

Seconds = Annotated[float, typer.Option(min=1, help="decision, record: how long, of each case.")]
Minutes = Annotated[float | None, typer.Option(min=0.1, help="decision, record: in place of --seconds.")]
All = Annotated[
    bool,
    typer.Option(
        "--all",
        help="cycle: one question a case: voxels, cameras, pixels, what moves, threads, volume and surface, and "
        "other systems on the same images; about ten minutes.",
    ),
]
Against = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="start, parts: src of another checkout, measured in turns with this package."
    ),
]
Captures = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="calibration: keep simulated captures here, and take those that are there."
    ),
]
Examples = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="calibration: the examples' site files. Default: examples of a checkout."
    ),
]
Part = Annotated[
    list[str] | None,
    typer.Option(
        help="calibration: only real, coverage, images, captures, intrinsics, machine, refine or drift; "
        "may be repeated."
    ),
]


def bench(
    what: Annotated[
        Literal["cycle", "decision", "start", "parts", "laws", "machine", "record", "calibration"],
        typer.Argument(
            help="cycle: carve and whole cycles; decision: exposure to decision in the running monitor; "
            "start: a new process to its first answer; parts: the machine in images and space, motions, a path; "
            "laws: what ages and own links cost a pass; machine: what triangles cost; record: whether recording "
            "keeps up; calibration: how well cameras are found."
        ),
    ] = "cycle",
    quick: Annotated[bool, typer.Option(help="Few rounds: a first impression in under a minute.")] = False,
    all_: All = False,
    cameras: Annotated[int, typer.Option(min=1, max=255, help="How many cameras.")] = 21,
    size: Annotated[str, typer.Option(help="Of their images: vga, qqvga or thesis.")] = "vga",
    threads: Annotated[int | None, typer.Option(min=1, help="Default: all cores.")] = None,
    seconds: Seconds = 30.0,
    minutes: Minutes = None,
    octomap: Annotated[bool, typer.Option(help="Also run OctoMap, where pyoctomap is installed.")] = True,
    against: Against = None,
    captures: Captures = None,
    examples: Examples = None,
    part: Part = None,
    json: JsonFile = None,
) -> None:
    """Measure carve and whole cycles in the simulated room, each in its own process; or something else."""
    seconds = seconds if minutes is None else 60 * minutes
    if what == "calibration":
        from elbowroom.cli.evaluate.bench_calibration_run import run_bench_calibration

        run_bench_calibration(quick, captures, tuple(part or ()), json, examples)
    elif what == "decision":
        from elbowroom.cli.evaluate.bench_run import run_bench_decision

        run_bench_decision(5.0 if quick else seconds, cameras, size, threads, json)
    elif what == "start":
        from elbowroom.cli.evaluate.bench_run import run_bench_start

        run_bench_start(quick, against, json)
    elif what == "parts":
        from elbowroom.cli.evaluate.bench_run import run_bench_parts

        run_bench_parts(quick, threads, against, json)
    elif what == "laws":
        from elbowroom.cli.evaluate.bench_run import run_bench_laws

        run_bench_laws(quick, cameras, size, threads, json)
    elif what == "record":
        from elbowroom.cli.evaluate.bench_run import run_bench_record

        run_bench_record(quick, cameras, size, seconds, json)
    elif what == "machine":
        from elbowroom.cli.evaluate.bench_run import run_bench_machine

        run_bench_machine(quick, cameras, json)
    elif all_:
        from elbowroom.cli.evaluate.bench_all_run import run_bench_all

        run_bench_all(quick, octomap, json)
    else:
        from elbowroom.cli.evaluate.bench_run import run_bench_cycle

        run_bench_cycle(quick, cameras, size, threads, octomap and not quick, json)
