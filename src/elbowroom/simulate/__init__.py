"""A room to try everything in: solids that move, depth cameras that see them, and what is really there."""

from elbowroom.simulate.cameras import Optics, Walls, wall_cameras
from elbowroom.simulate.glb import solids_of_glb
from elbowroom.simulate.room import InterventionRoom
from elbowroom.simulate.sensor import render
from elbowroom.simulate.setups import SETUPS, Movement, Setup, setup
from elbowroom.simulate.solid import Moment, Solid
from elbowroom.simulate.truth import Truth, true_occupancy

__all__ = [
    "SETUPS",
    "InterventionRoom",
    "Moment",
    "Movement",
    "Optics",
    "Setup",
    "Solid",
    "Truth",
    "Walls",
    "render",
    "setup",
    "solids_of_glb",
    "true_occupancy",
    "wall_cameras",
]
