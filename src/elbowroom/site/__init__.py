"""One file that says all of a room."""

from elbowroom.site.memory import Memory, memory_of
from elbowroom.site.site import SIMULATED_ROOM, Site

__all__ = ["SIMULATED_ROOM", "Memory", "Site", "memory_of"]
