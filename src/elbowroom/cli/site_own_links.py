"""`elbowroom site own-links`: pairs of the machine's links that need not be compared, written to a file."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile, SitePath


def own_links(
    site_path: SitePath,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The file to write, YAML.")],
    poses: Annotated[
        int, typer.Option("--poses", min=100, help="So many poses, drawn from the joints' limits, are tried.")
    ] = 10_000,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    json_file: JsonFile = None,
) -> None:
    """Find pairs of the machine's links that need not be compared, and write them to a file that the site can name.

    As MoveIt's setup assistant does: links that a joint joins, that touch in nearly
    all poses, that touch where all joints are at zero, or that came within 2 cm in no
    pose. Look at the file: a pair that stands there is not compared at all. Then name
    it in the site's machine, own_links; of several machines, beside machines. An SRDF
    that came with the robot does as well (machine: srdf).
    """
    from rich.console import Console

    from elbowroom.errors import SiteError
    from elbowroom.files.atomic import whole_file
    from elbowroom.files.json_rows import write_json
    from elbowroom.machine.own_links import REASONS, OwnLinks
    from elbowroom.motion.own_pairs import found_pairs
    from elbowroom.site import Site

    site = Site.load(site_path)
    machine = site.machine()
    if machine is None:
        raise SiteError(f"{site_path}: machine: missing; its links are what is compared")
    if out.exists() and not force:
        raise SiteError(f"{out}: is there already; choose another name, or --force to replace it")
    with Console(stderr=True).status("trying poses") as status:
        found = found_pairs(
            machine, poses, tell=lambda done: status.update(f"trying poses: {done} of {poses}")
        )
    with whole_file(out) as unfinished:
        unfinished.write_text(OwnLinks.as_yaml(machine.name, poses, found), encoding="utf-8")
    write_json(json_file, [{"machine": machine.name, "poses": poses, **found}])
    for reason, words in REASONS.items():
        print(f"{reason:9} {len(found[reason]):4}  {words}")
    where = "own_links, beside machines" if site.entry.machines else "machine: own_links"
    print(f"{out} written; look at it, then name it in {site_path}: {where}")
