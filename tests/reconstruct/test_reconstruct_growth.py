"""By how much the body is grown: by pixels, of their narrower side, within bounds."""

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.growth import MOST_GROWTH_M, PITCHES, growth_of, pixel_width_m
from elbowroom.reconstruct.terms import Terms
from reference import reconstruct_scenes as scenes

AHEAD = (1.0, 0.0, 0.0)


def cameras_of(*focals_px):
    return [scenes.camera_at(f"c{n}", (-2, 0, 0), AHEAD, focal=focal) for n, focal in enumerate(focals_px)]


def grid_of(edge):
    return VoxelGrid.covering((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), edge)


@pytest.mark.parametrize("edge", [0.01, 0.02, 0.05])
@pytest.mark.parametrize("focal", [30.0, 150.0, 400.0, 5000.0])
def test_growth_is_what_a_pixel_covers_within_bounds(edge, focal):
    cameras = cameras_of(focal)
    for lateral_px in (0.0, 0.5):
        growth = growth_of(grid_of(edge), cameras, Terms(margin=Margin(lateral_px=lateral_px)))
        due = (PITCHES + lateral_px) * 2.0 / (1.02 * focal) + edge / 4
        assert growth == pytest.approx(min(due, max(edge / 2, MOST_GROWTH_M)))
        assert edge / 4 <= growth <= max(edge / 2, MOST_GROWTH_M)


def test_growth_is_what_the_terms_say_and_half_a_voxel_without_cameras():
    assert growth_of(grid_of(0.05), cameras_of(100.0), Terms(body_growth_m=0.03)) == 0.03
    assert growth_of(grid_of(0.05), [], Terms()) == 0.025


def test_a_pixel_is_as_wide_as_of_the_middle_camera():
    assert pixel_width_m(cameras_of(100.0, 200.0, 400.0), np.zeros(3)) == pytest.approx(2.0 / (1.02 * 200.0))
