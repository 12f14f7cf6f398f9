"""Intrinsics that are no result: just within each limit nothing is said, just beyond it what it most likely is."""

import re
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.calibrate.intrinsics import FoundIntrinsics
from elbowroom.calibrate.intrinsics.doubt import FOCAL_SHARE, MIDDLE, UNEVEN, UNSURE, WORST_PX, doubts_of_lens
from elbowroom.geometry import DepthCamera, Intrinsics

BEFORE = DepthCamera("north", 640, 480, np.eye(4), Intrinsics(320.0, 320.0, 319.5, 239.5))
IN, BEYOND = 0.999, 1.001


def found(sigma_px=1.0, left_px=0.2, **lens):
    camera = replace(BEFORE, intrinsics=replace(BEFORE.intrinsics, **lens))
    residuals = np.full((40, 2), left_px)
    none = np.zeros((0, 4, 4))
    sigma = np.array([sigma_px, sigma_px, 1.0, 1.0])
    return FoundIntrinsics(
        camera, BEFORE, sigma, 1.0, 0.0, (0.01, 0.01), residuals, np.zeros(0), (), none, ()
    )


def longer(by):
    return {"fx": 320.0 * by, "fy": 320.0 * by, "sigma_px": 1.0}


LIMITS = {
    "a lens of a larger image": (
        lambda by: longer(1 + FOCAL_SHARE * by),
        "became 416 px.* of an image of 492 x 369",
    ),
    "a lens of a smaller image": (lambda by: longer(1 / (1 + FOCAL_SHARE * by)), "became 246 px"),
    "fx beside fy": (lambda by: {"fx": 320.0 * (1 + UNEVEN * by)}, "fx 352 and fy 320 px differ"),
    "cx": (lambda by: {"cx": 319.5 + MIDDLE * 640 * by}, "principal point .480, 240. is far from"),
    "cy": (lambda by: {"cy": 239.5 - MIDDLE * 480 * by}, "principal point .320, 119. is far from"),
    "how sure": (lambda by: {"sigma_px": UNSURE * 320.0 * by}, "known to 5 % only; more poses"),
    "what is left": (
        lambda by: {"left_px": WORST_PX * by},
        r"corners are 2\.0 px off \(rms\): another board",
    ),
}


@pytest.mark.parametrize("limit", LIMITS)
def test_a_limit_is_where_it_is_said_to_be(limit):
    of, words = LIMITS[limit]
    assert doubts_of_lens([found(**of(IN))]) == ()
    (doubt,) = doubts_of_lens([found(**of(BEYOND))])
    assert doubt.startswith("north: ")
    assert re.search(words, doubt), doubt


def test_what_is_not_a_number_is_no_result():
    (doubt,) = doubts_of_lens([found(sigma_px=np.nan)])
    assert "known to nan % only" in doubt


def test_each_camera_and_each_reason_is_said():
    two = [found(left_px=3.0, sigma_px=50.0), found(), found(cx=10.0)]
    assert len(doubts_of_lens(two)) == 3
