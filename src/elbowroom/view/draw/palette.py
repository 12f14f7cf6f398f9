"""What a voxel is shown as: one label each, with a word and a colour that colour-blind eyes tell apart."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import bits
from elbowroom.motion.verdict import Level
from elbowroom.reconstruct.free_space import FreeSpace

Colour = tuple[int, int, int]


class Label(IntEnum):
    """How a voxel is shown. Zero is unseen: what nobody labels is not known to be free."""

    UNSEEN = 0
    BLIND = 1
    SURFACE = 2
    FREE = 3
    BODY = 4


WORDS: dict[Label, str] = {
    Label.FREE: "free",
    Label.BODY: "own body (free)",
    Label.SURFACE: "surface",
    Label.UNSEEN: "unseen",
    Label.BLIND: "blind",
}
"""The word of each label, in the order in which legends show them."""

COLOURS: dict[Label, Colour] = {
    Label.FREE: (222, 239, 248),
    Label.BODY: (0, 158, 115),
    Label.SURFACE: (213, 94, 0),
    Label.UNSEEN: (126, 131, 138),
    Label.BLIND: (240, 200, 66),
}
"""Colours after Okabe and Ito (2008), and apart in lightness too, so that they survive a grey print."""
IN_3D: dict[Label, Colour] = {
    Label.SURFACE: (103, 71, 166),
    Label.UNSEEN: (161, 170, 194),
    Label.BLIND: (255, 215, 40),
}
"""Blocked space where the room is drawn, on the page and in pictures: beside levels, and before grey walls."""
LEVEL_COLOURS: dict[Level, Colour] = {
    Level.STOP: (155, 0, 5),
    Level.DECELERATE: (217, 110, 18),
    Level.INFORM: (112, 170, 255),
    Level.CLEAR: (36, 110, 101),
}
"""Red, orange, blue, green: of the page, of pictures, of swept volumes. Of these and `IN_3D` no two are nearer than 28
(CIE 1976 Lab), seen with all cones or without one kind (Machado, Oliveira and Fernandes 2009)."""

INK: Colour = (24, 32, 44)
SOFT_INK: Colour = (96, 106, 118)
PAPER: Colour = (255, 255, 255)
MACHINE_INK: Colour = (0, 44, 92)
CAMERA_INK: Colour = (120, 28, 109)


def labels(space: FreeSpace) -> NDArray[np.uint8]:
    """The label of each voxel, shape of the grid, index order x, y, z; each voxel has exactly one."""
    volume = np.full(space.grid.shape, Label.UNSEEN, dtype=np.uint8)
    volume[bits.unpack(space.blind_words & ~space.surface_words, space.grid)] = Label.BLIND
    volume[space.surface] = Label.SURFACE
    volume[space.free] = Label.FREE
    volume[bits.unpack(space.free_words & space.body_words, space.grid)] = Label.BODY
    return volume


def shares(volume: NDArray[np.uint8]) -> dict[Label, float]:
    """The share of each label in a volume or section of labels, 0 to 1; they add up to 1."""
    counts = np.bincount(volume.reshape(-1), minlength=len(Label))
    return {label: float(counts[label]) / max(volume.size, 1) for label in WORDS}


def colour_table() -> NDArray[np.uint8]:
    """Colours by label, shape (number of labels, 3), for `table[labels]`."""
    return np.array([COLOURS[label] for label in sorted(Label)], dtype=np.uint8)
