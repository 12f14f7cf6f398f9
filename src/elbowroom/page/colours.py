"""Colours of the page: apart for eyes that lack one kind of cones, and in lightness too."""

from elbowroom.motion import Level
from elbowroom.view.draw.palette import IN_3D, LEVEL_COLOURS, Colour, Label

SURFACE, UNSEEN, BLIND = (IN_3D[label] for label in (Label.SURFACE, Label.UNSEEN, Label.BLIND))
CONTACT: Colour = (0, 2, 30)
MACHINE: Colour = (205, 210, 218)
MACHINE_INK: Colour = (60, 70, 84)
BOX: Colour = (120, 128, 138)
CAMERA_WELL: Colour = (0, 114, 178)
CAMERA_ILL: Colour = (213, 94, 0)
LEVELS = LEVEL_COLOURS
"""Of all colours here that mean something no two are nearer than 28, as `view.draw.palette` says."""
MARKS: dict[Level, str] = {Level.STOP: "■", Level.DECELERATE: "▲", Level.INFORM: "●", Level.CLEAR: "○"}
"""A shape for each level, so that it does not hang on colour alone."""


def css(colour: Colour) -> str:
    """As a style sheet has it."""
    return "#" + "".join(f"{part:02x}" for part in colour)
