"""`elbowroom plan`: a room on a page, cameras that can be dragged, and what that changes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from elbowroom.cli.options import VoxelSize
from elbowroom.errors import InputError

if TYPE_CHECKING:
    from elbowroom.site import Site

PlanSite = Annotated[
    str | None,
    typer.Argument(
        metavar="SITE",
        help="A site file, or a room of the package: simulated, thesis, setup1 to setup6. Default: simulated.",
    ),
]
PlanOut = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Where the site file goes when it is saved. Default: SITE_planned.yaml, here."
    ),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Begin anew, whatever plan was kept beside FILE.")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port of the page, at 127.0.0.1. 0: any.")]
Language = Annotated[str, typer.Option(help="Words of the page: en, de.")]


def plan(
    site: PlanSite = None,
    out: PlanOut = None,
    fresh: Fresh = False,
    port: Port = 8139,
    language: Language = "en",
    voxel_size: VoxelSize = None,
) -> None:
    """Plan a room by hand, on a page at 127.0.0.1: drag cameras, and read what that changes.

    Cameras are dragged and turned, sensors chosen, the machine moved by sliders,
    people and furniture placed, of the package or of a GLB. What is seen, what
    is valid, the smallest object that is seen, free space found and price follow.
    A joint is driven until it would stop; a person walks through, and it is said
    where nobody sees them. All can be undone, and saved as a site file.

    The plan is kept beside FILE all along (.plan.json): Ctrl-C loses nothing, and
    the same command goes on with it.
    """
    from rich.console import Console

    from elbowroom.cli.plan_run import run_plan
    from elbowroom.page.words import words_of

    words = words_of(language)
    given, stem = _site(site)
    path = Path(f"{stem}_planned.yaml") if out is None else out
    if path.suffix not in (".yaml", ".yml"):
        raise InputError(f"--out: {path} must end in .yaml")
    if not path.absolute().parent.is_dir():
        raise InputError(f"--out: no folder {path.absolute().parent}; name one that exists")
    run_plan(Console(), given, words, path.absolute(), (port, fresh, voxel_size))


def _site(text: str | None) -> "tuple[Site, str]":
    """The site of that file or name, and what files of it begin with."""
    from elbowroom.page.plan.package_room import ROOMS, package_room
    from elbowroom.site import Site

    name = text or ROOMS[0]
    if name in ROOMS and not Path(name).is_file():
        return package_room(name), name
    return Site.load(name), Path(name).stem
