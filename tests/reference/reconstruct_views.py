"""What a carve starts from, unpacked for naive twins: one image a camera, and what each says of each voxel."""

import numpy as np

from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.views import fill
from reference.reconstruct_pixel import Image
from reference.reconstruct_pyramid import bounds_of


def images_of(grid, cameras, frames, margin, model_depth=None):
    """The texels of all cameras, which test_reconstruct_pyramid.py compares with twins of their own."""
    layout = layout_of(grid, tuple(cameras), margin)
    views, _ = fill(layout, room_images(cameras, frames), model_depth or {})
    images = []
    for c, camera in enumerate(cameras):
        shape = (camera.height, camera.width)
        trust, doubt = (
            bounds_of(texels[layout.texels[c]].reshape(shape).copy())
            for texels in (views.texels.trust_texels, views.texels.doubt_texels)
        )
        record = views.cameras[c]
        images.append(
            Image(
                camera,
                np.array(record["margin"].item()),
                record["lateral_px"],
                record["quantum"],
                trust,
                doubt,
                lowest=int(record["lowest"]),
                split=bool(record["explained"]),
                blank=bool(record["blank"]),
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
