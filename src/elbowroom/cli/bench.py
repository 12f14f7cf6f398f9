"""`elbowroom bench`: how long each stage takes on this computer."""

from elbowroom.cli.options import JsonFile
from elbowroom.errors import ElbowroomError


def bench(json: JsonFile = None) -> None:
    """Measure each stage on this computer."""
    raise ElbowroomError("bench: is not part of this version yet")
