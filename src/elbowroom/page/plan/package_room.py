"""Rooms of the package, to plan in without a file of one's own."""

import tempfile
from functools import cache
from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.files.yaml_file import read_yaml, write_yaml
from elbowroom.simulate.setups import SETUPS
from elbowroom.site import Site
from elbowroom.site.schema import EVEN_SETTINGS
from elbowroom.site.site import SIMULATED_ROOM, THESIS_ROOM

ROOMS = ("simulated", "thesis", *(setup.name for setup in SETUPS))
"""Their names."""


@cache
def package_room(name: str) -> Site:
    """The site of a room of the package.

    Args:
        name: one of `ROOMS`.

    Raises:
        InputError: there is no such room.
    """
    if name == "simulated":
        return Site.load(SIMULATED_ROOM)
    if name == "thesis":
        return Site.load(THESIS_ROOM)
    if name not in ROOMS:
        raise InputError(f"room: {name!r} is unknown, known are {', '.join(ROOMS)}")
    return _setup_site(name)


def _setup_site(name: str) -> Site:
    """The room of a setup of the thesis, with the C-arm and the sensors of the thesis' room."""
    room, tried = read_yaml(SIMULATED_ROOM), read_yaml(THESIS_ROOM)
    content = {key: value for key, value in room.items() if key != "simulated"}
    content |= {
        "name": name,
        "room": {"mesh": name},
        "camera_defaults": tried["camera_defaults"],
        "placement": tried["placement"],
    }
    assert not set(EVEN_SETTINGS) & set(content)
    path = Path(tempfile.mkdtemp(prefix="elbowroom-plan-")) / f"{name}.yaml"
    write_yaml(path, content, "a room of the package", None)
    return Site.load(path)
