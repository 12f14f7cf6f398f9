"""Colours of the page: apart for eyes that lack one kind of cones, and in lightness too."""

from elbowroom.motion import Level

Colour = tuple[int, int, int]

SURFACE: Colour = (103, 71, 166)
UNSEEN: Colour = (161, 170, 194)
BLIND: Colour = (255, 215, 40)
CONTACT: Colour = (0, 2, 30)
MACHINE: Colour = (205, 210, 218)
MACHINE_INK: Colour = (60, 70, 84)
BOX: Colour = (120, 128, 138)
CAMERA_WELL: Colour = (0, 114, 178)
CAMERA_ILL: Colour = (213, 94, 0)
LEVELS: dict[Level, Colour] = {
    Level.STOP: (155, 0, 5),
    Level.DECELERATE: (217, 110, 18),
    Level.INFORM: (112, 170, 255),
    Level.CLEAR: (36, 110, 101),
}
"""Red, orange, blue, green. Of all colours here that mean something no two are nearer than 28 (CIE 1976 Lab), seen with
all cones or without one kind (Machado, Oliveira and Fernandes 2009)."""
MARKS: dict[Level, str] = {Level.STOP: "■", Level.DECELERATE: "▲", Level.INFORM: "●", Level.CLEAR: "○"}
"""A shape for each level, so that it does not hang on colour alone."""


def css(colour: Colour) -> str:
    """As a style sheet has it."""
    return "#" + "".join(f"{part:02x}" for part in colour)
