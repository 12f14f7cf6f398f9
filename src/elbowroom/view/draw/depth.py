"""A depth image as a picture for people."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

NEAR_TO_FAR = np.array(
    [(253, 231, 37), (94, 201, 98), (33, 145, 140), (59, 82, 139), (68, 1, 84)], dtype=np.float64
)
"""Five stops of the viridis map, which falls evenly in lightness: near is bright, far is dark."""
NO_RETURN = (255, 255, 255)


def depth_picture(
    depth_m: NDArray[np.floating], *, near_m: float | None = None, far_m: float | None = None
) -> Image.Image:
    """A colour picture of a depth image: near yellow, far violet, no return white.

    Args:
        depth_m: shape (height, width) [m]; what is not a finite number above zero is no return.
        near_m, far_m: the range of the colours [m]; None: the 1st and 99th percentile of the image.
    """
    depth = np.asarray(depth_m, dtype=np.float64)
    valid = np.isfinite(depth) & (depth > 0)
    picture = np.empty((*depth.shape, 3), dtype=np.uint8)
    picture[:] = NO_RETURN
    if valid.any():
        low, high = np.percentile(depth[valid], (1, 99))
        near = low if near_m is None else near_m
        far = high if far_m is None else far_m
        place = np.clip((depth[valid] - near) / max(far - near, 1e-9), 0, 1) * (len(NEAR_TO_FAR) - 1)
        stops = np.arange(len(NEAR_TO_FAR))
        colour = [np.interp(place, stops, NEAR_TO_FAR[:, channel]) for channel in range(3)]
        picture[valid] = np.stack(colour, axis=-1).round().astype(np.uint8)
    return Image.fromarray(picture)
