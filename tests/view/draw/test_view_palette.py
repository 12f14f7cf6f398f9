"""Colours that mean something are told apart by every eye, and before grey walls."""

from itertools import combinations

import numpy as np
import pytest

from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.view.draw.palette import IN_3D, LEVEL_COLOURS, Label
from reference.colour import APART, CONES, lab

WALL = (225, 225, 225)
BEFORE_WALLS = 20.0


@pytest.mark.parametrize("cones", CONES)
def test_levels_and_blocked_space_are_told_apart_in_one_picture(cones):
    known = {**IN_3D, **LEVEL_COLOURS}
    assert len(known) == 7
    for one, other in combinations(known, 2):
        assert np.linalg.norm(lab(known[one], CONES[cones]) - lab(known[other], CONES[cones])) > APART, (
            one,
            other,
        )
    for name, colour in known.items():
        assert np.linalg.norm(lab(colour, CONES[cones]) - lab(WALL, CONES[cones])) > BEFORE_WALLS, name


def test_the_page_and_pictures_have_the_same_colours():
    assert colours.LEVELS is LEVEL_COLOURS and set(LEVEL_COLOURS) == set(Level)
    assert (
        IN_3D[Label.SURFACE],
        IN_3D[Label.UNSEEN],
        IN_3D[Label.BLIND],
    ) == (colours.SURFACE, colours.UNSEEN, colours.BLIND)
