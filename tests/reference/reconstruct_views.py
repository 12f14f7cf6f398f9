"""What a carve starts from, unpacked for naive twins: one image a camera, and what each says of each voxel."""

import numpy as np

from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.kernels import box as box
from elbowroom.reconstruct.views import fill, layout_of
from reference.reconstruct_pixel import Image
from reference.reconstruct_pyramid import bounds_of


def images_of(grid, cameras, frames, margin, model_depth=None):
    """The texels of all cameras, which test_reconstruct_pyramid.py compares with twins of their own."""
    layout = layout_of(grid, tuple(cameras), margin)
    views, _ = fill(layout, room_images(cameras, frames), model_depth or {})
    images = []
    for c, camera in enumerate(cameras):
        own = slice(views.texel_first[c], views.texel_first[c + 1])
        shape = (camera.height, camera.width)
        trust, doubt = (
            bounds_of(texels[own].reshape(shape).copy())
            for texels in (views.trust_texels, views.doubt_texels)
        )
        row = views.numbers[c]
        images.append(
            Image(
                camera,
                row[box.MARGIN : box.MARGIN + 5].copy(),
                row[box.LATERAL],
                row[box.QUANTUM],
                trust,
                doubt,
                lowest=int(row[box.LOWEST]),
                split=bool(row[box.SPLIT]),
                blank=bool(row[box.BLANK]),
            )
        )
    return images


def says_of(grid, images, say):
    """What `say(image, centre, edge)` answers for each camera and voxel, shape (cameras, *grid.shape)."""
    says = np.zeros((len(images), *grid.shape), dtype=int)
    for n, image in enumerate(images):
        for voxel in np.ndindex(grid.shape):
            says[(n, *voxel)] = say(image, grid.centre_of(voxel), grid.voxel_size_m)
    return says
