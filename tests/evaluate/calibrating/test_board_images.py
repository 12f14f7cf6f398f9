"""Boards in rendered images: found where they are, and sure of it as far as is true."""

import numpy as np
import pytest

from elbowroom.evaluate.calibrating.board_images import COARSE, INSIDE, misses_of, seen_views
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import wall_cameras


@pytest.mark.parametrize(("size", "noise"), [("qqvga", "kinect_v1"), ("thesis", "tof")])
def test_poses_from_one_small_image_are_as_sure_as_is_said(size, noise):
    camera = wall_cameras(1, size=size, noise=NOISE_PRESETS[noise])[0]
    seen = [(pose, view) for pose, view in seen_views(camera, COARSE, 8, 5) if view is not None]
    assert len(seen) >= 4
    misses = [misses_of(camera, COARSE, view, pose) for pose, view in seen]
    assert max(np.hypot(*miss.common_px) for miss in misses) < 0.5
    # all of these poses inside, but for one, would be the rule at 95 %
    assert sum(miss.square > 2 * INSIDE for miss in misses) <= 1
    # small squares have a few pixels within them that tell the plane
    assert np.median([len(view.plane_depth_m) for _, view in seen]) >= 12
