"""What never returned may be masked: no pixel that ever did, no specks, no threads."""

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.never import Never

CAMERA = DepthCamera("one", 60, 40, np.eye(4), Intrinsics(50, 50, 29.5, 19.5), max_depth_m=6.0)


def never(*images):
    found = Never(CAMERA)
    for image in images:
        found.add(DepthFrame("one", 0, image.astype(np.float32)))
    return found


def image():
    return np.full((40, 60), 2.0)


def test_a_dark_corner_is_masked_to_the_pixel():
    dark = image()
    dark[:8, :10] = 0
    masked, regions = never(dark, dark).mask()
    np.testing.assert_array_equal(masked, dark == 0)
    assert regions == 1


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf, 6.0, 7.0, -1.0])
def test_whatever_is_no_return_counts_as_none(value):
    dark = image()
    dark[:, :9] = value
    assert never(dark).mask()[0][:, :9].all()


def test_a_pixel_that_ever_returned_is_not_masked():
    dark, lit = image(), image()
    dark[:, :10] = 0
    lit[:, 5:] = 0
    masked, _ = never(dark, lit).mask()
    np.testing.assert_array_equal(np.flatnonzero(masked.any(axis=0)), np.arange(5, 10))


def test_specks_and_threads_are_not_masked():
    dark = image()
    dark[10, :] = 0
    dark[0, 0] = 0
    masked, regions = never(dark).mask()
    assert not masked.any() and regions == 0


def test_what_does_not_touch_the_border_is_masked_only_if_asked():
    dark = image()
    dark[10:20, 10:20] = 0
    assert not never(dark).mask()[0].any()
    np.testing.assert_array_equal(never(dark).mask(inside=True)[0], dark == 0)
