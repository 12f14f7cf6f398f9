"""The run of `elbowroom plan`."""

import time
from pathlib import Path

from rich.console import Console

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.opened import open_plan
from elbowroom.page.words import Words
from elbowroom.site import Site

LISTENS_S = 0.1


def run_plan(
    console: Console, site: Site, words: Words, out: Path, how: tuple[int, bool, float | None]
) -> None:
    """Serves the page of a plan until somebody asks for the end; then the plan is kept.

    Args:
        console: where it is said where the page is.
        site: the file.
        words: of the language.
        out: where the site file goes.
        how: port, whether to begin anew, edge of a voxel or None [m].

    Raises:
        InputError: the port is taken, a room that cannot be read, or a kept file that is no plan of this site.
        PackageError: viser is missing.
    """
    port, is_fresh, voxel_size_m = how
    compile_kernels(console, machine=site.entry.has_machine, motion=site.entry.has_machine, simulator=True)
    ground = Ground.of(site, voxel_size_m)
    for note in () if ground.room is None else ground.room.notes:
        console.print(f"note: {note}", highlight=False, soft_wrap=True)
    with asked_to_end() as is_over:
        session = open_plan(ground, words, out, port=port, is_fresh=is_fresh)
        assert session.page is not None
        console.print(f"plan: {session.page.url} (Ctrl-C ends)", highlight=False)
        console.print(f"kept in {session.kept_at}", highlight=False, soft_wrap=True)
        try:
            while not is_over():
                time.sleep(LISTENS_S)
        finally:
            session.stop()
            session.page.stop()
    console.print(f"the plan is kept in {session.kept_at}", highlight=False, soft_wrap=True)
