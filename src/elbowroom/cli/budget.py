"""`elbowroom budget`: how far people have to stay from the machine, and why so far."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from elbowroom.cli.options import JsonFile, VoxelSize, options_named, parse_resolution, use_threads

if TYPE_CHECKING:
    from elbowroom.monitor.separation.budget import Budget


def budget(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="SITE", help="A site file. Default: a simulated intervention room."),
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=0.5, max=3600, help="Run the monitor for so long, to measure.")
    ] = 5.0,
    voxel_size: VoxelSize = None,
    cameras: Annotated[
        int | None, typer.Option(min=1, max=200, help="Number of cameras of a simulated room.")
    ] = None,
    resolution: Annotated[
        str | None, typer.Option(metavar="WxH", help="Size of a simulated room's images, such as 160x120.")
    ] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="Cores to use. Default: all.")] = None,
    json: JsonFile = None,
) -> None:
    """Measure the reaction time and add up the distances that have to stay free.

    The monitor runs for some seconds over the site's frames. Its reaction time is
    measured, worst case, from the middle of an exposure to the decision; with the
    site's speeds and braking times it makes the separation distances of ISO
    10218-2:2025 and ISO 13855:2024, as the literature gives them. Every term says
    where it comes from: a key of the site, measured, or what is assumed.

    In a simulated room frames are new when they come, however long it takes to
    make them, so that the time between them is the simulator's. Not a certified
    safety function.
    """
    size_px = None if resolution is None else parse_resolution(resolution)
    use_threads(threads)

    from elbowroom.cli.progress import Steps
    from elbowroom.cli.screen import console
    from elbowroom.files.json_rows import json_rows
    from elbowroom.monitor.separation.measuring import measured_budget
    from elbowroom.monitor.start.compiling import compile_kernels
    from elbowroom.monitor.start.start import started
    from elbowroom.site import Site
    from elbowroom.sources import live, open_room

    with options_named(cameras="--cameras", resolution="--resolution"), json_rows(json) as add:
        given = Site.simulated_room() if site is None else Site.load(site)
        room = live(open_room(given, voxel_size_m=voxel_size, cameras=cameras, resolution=size_px))
        room.machine_and_motions()  # what is wrong with the machine is said before anything is compiled
        screen = console()
        compile_kernels(screen, machine=True, motion=True, simulator=given.simulated is not None)
        with Steps(screen, 4) as steps:
            loop = started(room, steps.begin)
        found = measured_budget(loop, seconds)
        for row in found.rows():
            add(row)
    _show(found)


def _show(found: "Budget") -> None:
    from elbowroom.cli.screen import note, show
    from elbowroom.monitor.separation.budget import ASSUMED, GROUPS
    from elbowroom.view.report.blocks import Table
    from elbowroom.view.screen.words import NOT_CERTIFIED

    terms, separation = found.terms(), found.figures.separation
    speeds = {"reaching_m_s": separation.reaching_m_s, "walking_m_s": separation.walking_m_s}
    for group, title in GROUPS.items():
        own = [term for term in terms if term.group == group]
        if not own:
            continue
        lines = [
            ("= " * term.is_sum + term.symbol, term.words, _value(term.value, term.unit), term.source)
            for term in own
        ]
        show(Table(title.format(**speeds), ("", "term", "value", "where from"), lines, left=(0, 1, 3)))
        print()
    if found.reaction_s is None:
        note("no reaction time: the frames have no times; write separation.reaction_ms into the site file")
    else:
        note(f"ISO 13855 asks for {separation.required_fixed_m(found.reaction_s):.2f} m, by both values of K")
    for name, margin in found.margins.items():
        against = "what stands" if name == "standing" else "a person who steps out of unseen space"
        note(
            f"least margin in this run against {against}: {margin:.2f} m (looked up to {found.figures.look_m:.2f} m)"
        )
    note("Assumed: " + "; ".join(ASSUMED) + ".")
    note(NOT_CERTIFIED)


def _value(value: float, unit: str) -> str:
    return f"{value:.1f} ms" if unit == "ms" else f"{value:.3f} m"
