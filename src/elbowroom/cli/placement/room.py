"""The fixed room of a site, with what is to be said of how its mesh was read."""

import sys

from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.site import Site


def room_of(site: Site) -> FixedRoom | None:
    """The fixed room of a site; prints what a person should know of its mesh.

    Raises:
        SiteError: a mesh that cannot be read.
    """
    room = FixedRoom.of_site(site)
    for note in () if room is None else room.notes:
        print(f"note: {note}", file=sys.stderr)
    return room
