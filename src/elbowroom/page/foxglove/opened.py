"""Foxglove's face, opened by a run: like the page, in its own process, fed by a board of its own."""

from importlib.util import find_spec

from elbowroom.extras import install_command
from elbowroom.page.opened import OpenedPage
from elbowroom.sources import Room

PORT = 8765
"""At which Foxglove looks for a server, if nobody says otherwise."""


def opened_foxglove(room: Room, port: int = PORT) -> OpenedPage | str:
    """The face of a run, not opened yet; or why there is none, a line.

    Args:
        room: that is watched.
        port: at which; 0: any that is free.
    """
    for name in ("foxglove", "cryptography"):
        if find_spec(name) is None:
            return f"no foxglove: it needs {name}; install it with {install_command('foxglove')}"
    return OpenedPage(room, port, name="foxglove", program="elbowroom.page.foxglove.process")
