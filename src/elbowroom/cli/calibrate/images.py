"""Images of a capture of a board, as grey pictures to draw on."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.capture import images_by_pose
from elbowroom.calibrate.pages.pictures import grey_depth
from elbowroom.site import Site


class PoseImages:
    """Pictures to draw on: depth as grey.

    Args:
        site: whose recording they are.
    """

    def __init__(self, site: Site) -> None:
        self.by_view = {
            (image.camera.name, pose): image
            for pose, images in enumerate(images_by_pose(site))
            for image in images
        }

    def grey(self, camera: str, pose: int) -> NDArray[np.uint8] | None:
        """The depth image of a camera at a pose as grey."""
        image = self.by_view.get((camera, pose))
        if image is None:
            return None
        depth = image.read().depth_m
        known = depth[depth > 0]
        if not len(known):
            return None
        near, far = (float(v) for v in np.percentile(known, (2, 98)))
        return grey_depth(depth, near, far)
