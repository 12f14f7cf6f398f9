"""What a camera saw some time ago, and what of it still holds: an object may have moved since, in any direction.

A voxel is free *now* of all that one camera would have seen, if the voxel grown by a ball, by how far anything may
have moved since, was seen through *then*: what touches the voxel now was within the ball at the time. So the voxel's
faces move outwards by the ball's radius, and its outline in the image by that radius at the voxel's nearest depth.
"""

import numpy as np

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.geometry.kernels.pinhole import pixel_of
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.box import PLANE_EPS
from elbowroom.reconstruct.kernels.cone import Pixel, has_left, misses, prepare, steepness
from elbowroom.reconstruct.kernels.pixel import bounds_about, outline_of, pixels_within
from elbowroom.reconstruct.kernels.place import box_in

ROUNDING_M = 1e-6
"""More than float64 can err in where a point lies [m]."""


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _grown_outline(camera, middle, half, near):
    """Least and greatest column, least and greatest row of a grown voxel whose nearest depth is given [m]."""
    u0, u1, v0, v1 = outline_of(camera, middle, half)
    # a plane through the camera and the voxel's rim, moved by the ball's radius; at the nearest depth it is widest
    wide = camera.aged_m / near
    left, right = (u0 - camera.cx) / camera.fx, (u1 - camera.cx) / camera.fx
    top, bottom = (v0 - camera.cy) / camera.fy, (v1 - camera.cy) / camera.fy
    return (
        u0 - camera.fx * wide * np.sqrt(1.0 + left * left),
        u1 + camera.fx * wide * np.sqrt(1.0 + right * right),
        v0 - camera.fy * wide * np.sqrt(1.0 + top * top),
        v1 + camera.fy * wide * np.sqrt(1.0 + bottom * bottom),
    )


@uncounted(cache=True, error_model="numpy")
def _prepare_grown(camera, box, near, voxel):
    """Fills the scratch record for one voxel and camera, grown."""
    prepare(camera, box, voxel)
    for a in range(3):
        voxel.low[a] -= camera.aged_m
        voxel.high[a] += camera.aged_m
    for n in range(voxel.lines):
        line = voxel.line[n]
        # the normal of the plane through the camera and that edge of the voxel, in the camera's axes
        x, y = line[1] * camera.fx, line[2] * camera.fy
        z = line[0] + line[1] * camera.cx + line[2] * camera.cy
        voxel.line[n, 3] += camera.aged_m / near * np.sqrt(x * x + y * y + z * z)


@uncounted(cache=True, error_model="numpy")
def _are_free_beyond(camera, texels, pixels, reach, voxel):
    """Whether all pixels whose cones meet a grown voxel are free beyond it.

    Args:
        camera, texels: its record; those of all cameras.
        pixels: that may meet it.
        reach: the margin of depth [m], and from where on [quanta] what is free is free beyond the voxel.
        voxel: the scratch record, prepared.
    """
    margin, clear_from = reach
    across = (camera.width + 3) >> 2
    for tv in range(pixels.top >> 2, (pixels.bottom >> 2) + 1):
        for tu in range(pixels.left >> 2, (pixels.right >> 2) + 1):
            if texels.trust_tiles[camera.first_tile + tv * across + tu] >> np.uint32(16) >= clear_from:
                continue
            for v in range(max(pixels.top, 4 * tv), min(pixels.bottom, 4 * tv + 3) + 1):
                row = camera.first_texel + v * camera.width
                for u in range(max(pixels.left, 4 * tu), min(pixels.right, 4 * tu + 3) + 1):
                    texel = texels.trust_texels[row + u]
                    free_to = texel >> np.uint32(16)
                    if free_to >= clear_from or misses(voxel, u, v):
                        continue
                    _, steep_far = steepness(camera, u, v)
                    t = (free_to * camera.quantum - margin) / steep_far
                    if not has_left(camera, voxel, Pixel(u, v, free_to, texel), t):
                        return False
    return True


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _is_stopped_at(camera, texels, x, y, z):
    """Whether the pixel of a point in the camera's axes, which lies in the image, is free no farther than to it."""
    u, v = pixel_of(camera, x, y, z)
    at = np.sqrt(x * x + y * y + z * z) if camera.radial else z
    pixel = camera.first_texel + int(np.floor(v + 0.5)) * camera.width + int(np.floor(u + 0.5))
    return (texels.trust_texels[pixel] >> np.uint32(16)) * camera.quantum < at - ROUNDING_M


@uncounted(cache=True, error_model="numpy")
def _is_surely_stopped(camera, texels, middle):
    """Whether some point of a grown voxel, of a few on the rim of the ball about its middle, is surely not free.

    It settles most voxels that are not seen through, before every pixel is looked at.
    """
    x, y, z = middle
    far, aslant = camera.aged_m, 0.7071 * camera.aged_m
    if _is_stopped_at(camera, texels, x, y, z + far):
        return True
    for side in (-1.0, 1.0):
        if (
            _is_stopped_at(camera, texels, x + side * far, y, z)
            or _is_stopped_at(camera, texels, x, y + side * far, z)
            or _is_stopped_at(camera, texels, x + side * aslant, y, z + aslant)
            or _is_stopped_at(camera, texels, x, y + side * aslant, z + aslant)
            or _is_stopped_at(camera, texels, x + side * aslant, y + aslant, z)
            or _is_stopped_at(camera, texels, x + side * aslant, y - aslant, z)
        ):
            return True
    return False


@uncounted(cache=True, error_model="numpy")
def sees_through_grown(camera, texels, box, voxel):
    """Whether a camera sees through a voxel grown by what anything may have moved since its image.

    Args:
        camera: its record.
        texels: of all cameras.
        box: the voxel.
        voxel: scratch.
    """
    m, half, grown = camera.camera_from_world, 0.5 * box.edge, camera.aged_m
    middle = moved(m, box.x, box.y, box.z)
    reach_z = half * (abs(m[2, 0]) + abs(m[2, 1]) + abs(m[2, 2])) + grown
    near, far = middle[2] - reach_z, middle[2] + reach_z
    if near <= PLANE_EPS:
        return False
    pixels = pixels_within(camera, _grown_outline(camera, middle, half, near))
    if not pixels.whole or _is_surely_stopped(camera, texels, middle):
        return False
    if camera.radial:
        px, py, pz = middle
        far = np.sqrt(px * px + py * py + pz * pz) + 0.8660255 * box.edge + grown
    margin = margin_at(camera.margin, far)
    clear_from = np.uint32(min((far + margin) / camera.quantum + 2.0, 65535.0))
    least, _ = bounds_about(camera, texels, pixels)
    if least >= clear_from:
        return True
    _prepare_grown(camera, box, near, voxel)
    return _are_free_beyond(camera, texels, pixels, (margin, clear_from), voxel)


@uncounted(cache=True, error_model="numpy")
def still_through(camera, texels, voxels, boxes, voxel):
    """Of the set voxels of a block, a word, those that a camera sees through grown.

    Args:
        camera, texels, voxel: as of `sees_through_grown`.
        voxels: those that are asked, a word.
        boxes: all voxels of the block.
    """
    through, rest = np.uint64(0), voxels
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if sees_through_grown(camera, texels, box_in(boxes, lane), voxel):
            through |= bit
    return through
