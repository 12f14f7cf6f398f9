"""What kernels are told of the cameras of a carve: a record each, and the pixels of all in common arrays."""

from typing import NamedTuple

import numpy as np

from elbowroom.geometry.kernels.noise import DepthMargin

LEVELS = 15
"""Of windows at most: so often the side of an image halves until one texel is left (`geometry.camera.MAX_SIDE_PX`)."""

_MARGIN = np.dtype((np.record, [(name, "f8") for name in DepthMargin._fields]))
_FIELDS = np.dtype(
    [
        ("camera_from_world", "f8", (3, 4)),
        ("centre_in_world", "f8", 3),
        ("fx", "f8"),
        ("fy", "f8"),
        ("cx", "f8"),
        ("cy", "f8"),
        ("width", "i8"),
        ("height", "i8"),
        ("margin", _MARGIN),
        ("lateral_px", "f8"),
        ("aged_m", "f8"),
        ("quantum", "f8"),
        ("ray", "f8", (3, 3)),
        ("ray_half_width", "f8", 3),
        ("least_cosine", "f8"),
        ("half_extent", "f8", (2, 3)),
        ("half_diagonal", "f8", 2),
        ("offset", "f4", (2, 3, 64)),
        ("levels", "i8"),
        ("lowest", "i8"),
        ("level_first", "i8", LEVELS),
        ("level_stride", "i8", LEVELS),
        ("first_texel", "i8"),
        ("first_tile", "i8"),
        ("within", "i8", 4),
        ("radial", "?"),
        ("flies", "?"),
        ("blank", "?"),
        ("explained", "?"),
    ],
    align=True,
)
# records, and not plain structures: outside compiled code, too, their fields are attributes
CAMERA = np.dtype((np.record, _FIELDS))
"""One camera.

Pose: camera_from_world, centre_in_world [m]. Lens: fx, fy, cx, cy [px], width, height, whether depth is radial, and
whether pixels fly.
Margin: of depth (`geometry.kernels.noise.DepthMargin`), of direction [px], and the quantum that counts depth [m].

Rays: how a pixel's direction turns in the world, d_a = ray[0, a] + ray[1, a] u + ray[2, a] v along axis a, its half
width over a widened pixel, and the least cosine between a pixel's ray and the optical axis.

Boxes, of a voxel (0) and of a block of 4 voxels (1): half extents along the camera's axes, half the diagonal [m], and
offset: from child 0 to each of 64 children, in the camera's axes, x times fx and y times fy.

Where its pixels are: how many levels of windows, the finest of them, where each begins and its row length; where its
texels and tiles begin. Of this moment: which of its pixels are worked on (first row, one past the last, first column,
one past the last), whether nothing was delivered, whether the machine explains some of its pixels, and aged_m: how far
anything may have moved since it was exposed [m].
"""


class Texels(NamedTuple):
    """The pixels of all cameras, one after the other, as texels (`kernels.texels`).

    trust_texels: what pixels free; doubt_texels: what they measured of anything but the machine. trust_tiles,
    doubt_tiles: the least of 4 x 4 of them each. trust_squares, doubt_squares (4, tiles): these tiles, and the least of
    2 x 2, 4 x 4 and 8 x 8 of them from each on; filled where something asks for them.
    """

    trust_texels: np.ndarray
    doubt_texels: np.ndarray
    trust_tiles: np.ndarray
    doubt_tiles: np.ndarray
    trust_squares: np.ndarray
    doubt_squares: np.ndarray


class Views(NamedTuple):
    """All cameras of a carve: records, their texels, and windows over what pixels free (`kernels.pyramid`).

    aged: the same records with boxes grown by what anything may have moved since; order: in which cameras are asked,
    the newest first, which saves asking and leaves the same bits.
    """

    cameras: np.ndarray
    aged: np.ndarray
    order: np.ndarray
    texels: Texels
    windows: np.ndarray
