"""Where to put the cameras: verify a placement, find a better one, and what it means in use.

What finds a placement (`solver`) has a model of its own; what verifies it goes through the projection that carves.
"""

from elbowroom.placement.bill import bill
from elbowroom.placement.candidates import Candidate, Mount, candidates_of
from elbowroom.placement.detection import Capability, capability
from elbowroom.placement.even import Sweep, even_cameras, sweep
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.optimisation import Goal, Optimised, Search, optimise
from elbowroom.placement.rehearsal import Rehearsal, Settings, rehearse
from elbowroom.placement.requirement import Requirement
from elbowroom.placement.scenes import random_scenes
from elbowroom.placement.sensor import Sensor, known_sensors, sensors_of
from elbowroom.placement.verification import Verification, verify
from elbowroom.placement.worst import Place, worst_places
from elbowroom.site.written import write_site

__all__ = [
    "Candidate",
    "Capability",
    "FixedRoom",
    "Goal",
    "Mount",
    "Optimised",
    "Place",
    "Rehearsal",
    "Requirement",
    "Search",
    "Sensor",
    "Settings",
    "Sweep",
    "Verification",
    "bill",
    "candidates_of",
    "capability",
    "even_cameras",
    "known_sensors",
    "optimise",
    "random_scenes",
    "rehearse",
    "sensors_of",
    "sweep",
    "verify",
    "worst_places",
    "write_site",
]
