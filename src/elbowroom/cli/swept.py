"""What of the space that a site's motions sweep nobody sees, for `site check` and `placement verify`."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from elbowroom.cli.screen import show

if TYPE_CHECKING:
    from elbowroom.placement.swept.unseen import Swept
    from elbowroom.site import Site

POSES = 5
"""The machine is looked at in so many poses."""


def swept_row(site: "Site") -> tuple["Swept | None", dict[str, Any]]:
    """What is swept and what of it nobody sees, and as parts of a row; nothing where no motion can be asked."""
    machine = site.machine()
    if machine is None or not site.motions(machine):
        return None, {}
    from rich.console import Console

    from elbowroom.cli.site_moment import pose_to_draw
    from elbowroom.errors import InputError
    from elbowroom.monitor.start.compiling import compile_kernels
    from elbowroom.placement.fixed_room import FixedRoom
    from elbowroom.placement.swept.advice import one_more
    from elbowroom.placement.swept.poses import poses_of
    from elbowroom.placement.swept.unseen import swept_of
    from elbowroom.sources import cameras_of

    compile_kernels(Console(stderr=True), machine=True, motion=False, simulator=True)
    try:
        room = FixedRoom.of_site(site)
        poses, note = poses_of(site, machine, room, pose_to_draw(site, machine), POSES)
        found = swept_of(site.grid(), cameras_of(site), machine, site.motions(machine), poses, room)
        more = one_more(found, machine, room)
    except InputError as error:
        return None, {"swept_note": f"swept space was not looked at: {error}"}
    advice = None if more is None else more.words
    return found, {**found.row(), "swept_advice": advice, "swept_note": note}


def say_swept(row: Mapping[str, Any]) -> None:
    """Prints a table, a line for each link, what images end before, and one line of advice."""
    if row.get("swept_note"):
        print(f"note      {row['swept_note']}")
    if not row.get("swept_links"):
        return
    from elbowroom.evaluate.tables import table_of

    columns = {
        "link": "{link}",
        "sweeps": "{litres:.0f} l",
        "nobody sees": "{unseen_pct:.1f} %",
        "in no image": "{no_image_pct:.1f} %",
        "hidden": "{hidden_pct:.1f} %",
    }
    share, poses = row["swept_unseen_pct"], row["swept_poses"]
    print(f"swept     {share:.1f} % of the space that the motions sweep from {poses} poses nobody sees")
    show(table_of("", row["swept_links"], columns, ("link",)))
    for words in row["swept_warnings"]:
        print(f"warning   {words}")
    if row["swept_advice"] is not None:
        print(f"advice    {row['swept_advice']}")
