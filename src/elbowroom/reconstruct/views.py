"""Images of a moment as the arrays that carving kernels take."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.parallel import spread
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.kernels import flying as flying
from elbowroom.reconstruct.kernels import pyramid as pyramid
from elbowroom.reconstruct.kernels import texels as texels
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.texels import Counting
from elbowroom.reconstruct.layout import Buffers, Layout
from elbowroom.reconstruct.records import aged, margin_of, pitch_of
from elbowroom.reconstruct.regions import Rectangle

STEP = Margin(sigmas=3.0)
STEP_WITHOUT_NOISE = Margin(range_linear=0.005)
"""By how much depth must differ between neighbours to step, of cameras with a noise model and of others.

Were it the margin of the carve, a wider margin would lower fewer pixels and so could add free space.
"""

NO_IMAGE = np.zeros((0, 0), dtype=np.float32)
NO_TEXELS = np.zeros((0, 0), dtype=np.uint32)
NOTHING_FREE = np.uint32(0)
"""The texel of a pixel without a return."""
NOWHERE: Rectangle = (0, 0, 0, 0)
Pair = tuple[NDArray[np.uint32], NDArray[np.uint32]]
"""Of trust and of doubt."""


def fill(
    layout: Layout,
    images: RoomImages,
    model_depth: Mapping[str, Image],
    within: Sequence[Rectangle] | None = None,
) -> tuple[Views, Buffers]:
    """Builds the windows of all cameras; a camera without images is blank.

    Args:
        layout: cameras in a grid.
        images: of those cameras.
        model_depth: by camera, depth up to which the machine explains the pixel [m], 0 where it does not.
        within: by camera the pixels that the pixel test may ask, all else is left as it was in memory (`regions`);
            None: all pixels, and squares of doubt, which the test of footprints asks. Of aged images, squares of trust.

    Returns:
        What kernels take, and the buffers behind it, to be given back after the carve.
    """
    split = bool(model_depth) or any(
        camera.flying_pixels or camera.mask is not None for camera in layout.cameras
    )
    buffers = layout.take_buffers(split)
    records = layout.records.copy()

    def build(c: int) -> None:
        name, record = layout.cameras[c].name, records[c]
        own = _own_texels(layout, buffers, c)
        here = _all_of(own[0]) if within is None else within[c]
        apart = NOWHERE
        if name in images.least_m:
            bounds_m = images.least_m[name], images.greatest_m[name]
            record["explained"], apart = texels_of(
                layout.cameras[c], layout.counting[c], bounds_m, model_depth.get(name), own, here
            )
            mask = layout.cameras[c].mask
            if mask is not None:
                put_mask(mask, own)
                record["explained"], apart = True, here
            record["aged_m"] = images.aged_m.get(name, 0.0)
        else:
            record["blank"] = True
            part = slice(*here[:2]), slice(*here[2:])
            own[0][part], own[1][part] = 0, 0
        _fill_levels(record, buffers, layout.tiles[c], own, (here, apart))
        record["within"] = here
        held, tiles = buffers.texels, layout.tiles[c]
        if record["aged_m"] > 0.0:
            _fill_squares(held.trust_tiles[tiles], held.trust_squares[:, tiles], own[0].shape, here)
        if within is None and buffers.split:
            _fill_squares(held.doubt_tiles[tiles], held.doubt_squares[:, tiles], own[0].shape, here)

    spread(build, range(len(layout.cameras)))
    order = np.argsort(records["aged_m"], kind="stable")
    return Views(records, aged(records), order, buffers.texels, buffers.windows), buffers


def _own_texels(layout: Layout, buffers: Buffers, c: int) -> Pair:
    """One camera's part of the texels; one array twice, if doubt is not kept apart."""
    shape = (layout.cameras[c].height, layout.cameras[c].width)
    trust = buffers.texels.trust_texels[layout.texels[c]].reshape(shape)
    return trust, buffers.texels.doubt_texels[layout.texels[c]].reshape(shape) if buffers.split else trust


def _all_of(image: NDArray[Any]) -> Rectangle:
    """All pixels of an image."""
    return 0, image.shape[0], 0, image.shape[1]


def _tiles_of(shape: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of tiles of an image of so many rows and columns."""
    return -(-shape[0] // 4), -(-shape[1] // 4)


def _fill_levels(
    record: np.record, buffers: Buffers, here: slice, own: Pair, pixels: tuple[Rectangle, Rectangle]
) -> None:
    """Builds what stands above one camera's texels: windows and tiles.

    Args:
        record: of the camera.
        buffers: written.
        here: where its tiles are.
        own: its texels.
        pixels: those that are worked on, and a rectangle in them outside of which doubt is as trust.
    """
    trust, doubt = own
    within, apart = pixels
    shape = _tiles_of((trust.shape[0], trust.shape[1]))
    tiles = buffers.texels.trust_tiles[here].reshape(shape)
    pyramid.fill_levels(trust, record, tiles, buffers.windows, within)
    if buffers.split:
        doubt_tiles = buffers.texels.doubt_tiles[here].reshape(shape)
        top, bottom, left, right = within
        part = slice(top // 4, -(-bottom // 4)), slice(left // 4, -(-right // 4))
        doubt_tiles[part] = tiles[part]
        pyramid.fill_tiles(doubt, apart, doubt_tiles)


def _fill_squares(
    tiles: NDArray[np.uint32], squares: NDArray[np.uint32], shape: tuple[int, ...], within: Rectangle
) -> None:
    """Builds squares of tiles of one camera.

    Args:
        tiles: of the camera, flat.
        squares: (SQUARES, tiles), written.
        shape: of its image.
        within: the pixels that are worked on.
    """
    of_tiles = _tiles_of((shape[0], shape[1]))
    top, bottom, left, right = within
    here = top // 4, -(-bottom // 4), left // 4, -(-right // 4)
    levels = [level.reshape(of_tiles) for level in squares]
    part = slice(*here[:2]), slice(*here[2:])
    levels[0][part] = tiles.reshape(of_tiles)[part]
    for number, (smaller, larger) in enumerate(pairwise(levels), start=1):
        pyramid.squares_of(smaller, 1 << number, here, larger)


def _read_only(image: Image) -> Image:
    """The same image, as frames have it: to numba one that may be written is another type, to be compiled anew."""
    view = image.view()
    view.setflags(write=False)
    return view


def put_mask(mask: NDArray[np.bool_], own: Pair) -> None:
    """Masked pixels free nothing and dispute nothing, whatever they measured and whatever explains them.

    Pixels about them keep what they free and dispute: filters before this have taken a masked pixel for what it
    measured, so that a mask never adds to what its own camera sees through.

    Args:
        mask: all of the image or a part of it.
        own: texels of trust and of doubt, which must be kept apart; changed.
    """
    trust, doubt = own
    trust[mask], doubt[mask] = NOTHING_FREE, texels.NEUTRAL


def texels_of(
    camera: DepthCamera,
    counting: Counting,
    bounds_m: tuple[Image, Image],
    model_m: Image | None,
    own: Pair,
    within: Rectangle,
) -> tuple[bool, Rectangle]:
    """Level 0 of one camera: what its pixels free, and what they measured.

    Args:
        camera, counting: whose pixels, and how it counts depth.
        bounds_m: least and greatest depth per pixel, all of the image or a part of it [m].
        model_m: up to where the machine explains each pixel [m], 0 where it does not; None: it explains nothing.
        own: texels of trust and of doubt, written; may be one array where nothing is explained and no pixels fly.
        within: the pixels that are worked on. Of a camera whose pixels fly, those within `flying.SPREAD` pixels of
            its sides are as if nothing lay beyond.

    Returns:
        Whether the machine explains any pixels, and a rectangle outside of which both are the same.
    """
    trust, doubt = own
    model = NO_IMAGE if model_m is None else model_m
    # not one array by two names: the compiler could not tell, and would do one pixel at a time
    other = NO_TEXELS if doubt is trust else doubt
    least_m, greatest_m = bounds_m
    bounds_m = _read_only(least_m), _read_only(greatest_m)
    if not camera.flying_pixels:
        apart = texels.texels_of_frame(bounds_m, counting, model, (trust, other), within)
        return apart[0] < apart[1], apart
    step = margin_of(camera, STEP if camera.noise is not None else STEP_WITHOUT_NOISE)
    apart = flying.fly(bounds_m, counting, model, (pitch_of(camera), step), own, within)
    return apart[0] < apart[1], within
