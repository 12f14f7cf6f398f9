"""Pixels that never return: dark corners, a lens hood, walls beyond the sensor's range."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.sensing.frame import DepthFrame

LEAST_SHARE = 0.002
"""Regions smaller than this share of the image are not masked: single pixels that are lost are no region."""
BLOCK = np.ones((3, 3), dtype=np.bool_)
"""A pixel is masked only with others in such a block of which none ever returned: threads and specks are no region."""

Mask = NDArray[np.bool_]


@dataclass(slots=True, eq=False)
class Never:
    """Which pixels of a camera never returned, over the images that it was shown.

    Args:
        camera: whose.
    """

    camera: DepthCamera
    images: int = field(default=0, init=False)
    returned: Mask = field(init=False)

    def __post_init__(self) -> None:
        self.returned = np.zeros((self.camera.height, self.camera.width), dtype=np.bool_)

    def add(self, frame: DepthFrame) -> None:
        """Takes one more image into account, of the camera's size."""
        depth = frame.depth_m
        self.returned |= (depth > 0) & (depth >= self.camera.min_depth_m) & (depth <= self.camera.deepest_m)
        self.images += 1

    @property
    def share(self) -> float:
        """Of pixels that never returned, from 0 to 1."""
        return 1.0 - float(self.returned.mean())

    def mask(self, inside: bool = False) -> tuple[Mask, int]:
        """What may be masked, and in how many regions: no pixel that ever returned, no threads, no specks.

        Args:
            inside: regions as well that do not touch the image's border.
        """
        from scipy import ndimage  # slow to load, and no pass needs it

        wide = np.pad(~self.returned, 1, mode="edge")
        never = ndimage.binary_opening(wide, BLOCK)[1:-1, 1:-1]
        labels, _ = ndimage.label(never, BLOCK)
        sizes = np.bincount(labels.reshape(-1))
        at_border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
        regions = np.arange(len(sizes)) if inside else np.unique(at_border)
        kept = [int(label) for label in regions if label and sizes[label] >= LEAST_SHARE * labels.size]
        return np.isin(labels, kept), len(kept)
