"""What a camera saw some time ago, and what of it still holds: an object may have moved since, in any direction.

A voxel is free *now* of all that one camera would have seen, if the voxel grown by a ball, by how far anything may
have moved since, was seen through *then*: what touches the voxel now was within the ball at the time. So the voxel's
faces move outwards by the ball's radius, and its outline in the image by that radius at the voxel's nearest depth.
"""

import numpy as np

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.box import PLANE_EPS
from elbowroom.reconstruct.kernels.cone import Pixel, has_left, misses, prepare, steepness
from elbowroom.reconstruct.kernels.pixel import outline_of, pixels_within
from elbowroom.reconstruct.kernels.place import box_in

ROUNDING = 1e-9
"""More than float64 can err in how far a cone lies from a line, or in a direction."""
SQUARE_LEVEL = 2
"""So large are squares of tiles that are passed over at once (`pyramid.least_of_tiles`)."""


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
def _are_beyond(camera, voxel, square, least, margin):
    """Whether the cones of all pixels of a square miss a grown voxel, or have left it where each is free up to.

    Cones of many pixels are a wider one: what this says, each of them would say as well.

    Args:
        camera: its record.
        voxel: the scratch record, prepared.
        square: column and row of its middle, and how far the outermost pixels' are from it.
        least: that any is free up to [quanta].
        margin: of depth [m].
    """
    u, v, half = square
    for n in range(voxel.lines):
        line = voxel.line[n]
        most = line[0] + line[1] * u + line[2] * v + line[3] + half * (abs(line[1]) + abs(line[2]))
        if most < -ROUNDING:
            return True
    t = np.float64(least) * camera.quantum - margin
    if camera.radial:
        aside = (abs(u - camera.cx) + half + 0.5 + camera.lateral_px) / camera.fx
        above = (abs(v - camera.cy) + half + 0.5 + camera.lateral_px) / camera.fy
        t /= np.sqrt(1.0 + aside * aside + above * above)
    if t <= 0.0:
        return False
    for a in range(3):
        d = camera.ray[0, a] + camera.ray[1, a] * u + camera.ray[2, a] * v
        wide = half * (abs(camera.ray[1, a]) + abs(camera.ray[2, a])) + camera.ray_half_width[a] + ROUNDING
        if d > wide and t * (d - wide) > voxel.high[a]:
            return True
        if d < -wide and t * (d + wide) < voxel.low[a]:
            return True
    return False


@uncounted(cache=True, error_model="numpy")
def _is_tile_free(camera, texels, part, reach, voxel):
    """Whether all of some pixels whose cones meet a grown voxel are free beyond it.

    Args:
        camera, texels, reach, voxel: as of `_are_free_beyond`.
        part: first and last row, first and last column.
    """
    margin, clear_from = reach
    top, bottom, left, right = part
    for v in range(top, bottom + 1):
        row = camera.first_texel + v * camera.width
        for u in range(left, right + 1):
            texel = texels.trust_texels[row + u]
            free_to = texel >> np.uint32(16)
            if free_to >= clear_from or misses(voxel, u, v):
                continue
            _, steep_far = steepness(camera, u, v)
            t = (free_to * camera.quantum - margin) / steep_far
            if not has_left(camera, voxel, Pixel(u, v, free_to, texel), t):
                return False
    return True


@uncounted(cache=True, error_model="numpy")
def _are_free_beyond(camera, texels, pixels, reach, voxel):
    """Whether all pixels whose cones meet a grown voxel are free beyond it: squares of them, then tiles, then pixels.

    Args:
        camera, texels: its record; those of all cameras, with squares of trust.
        pixels: that may meet it.
        reach: the margin of depth [m], and from where on [quanta] what is free is free beyond the voxel.
        voxel: the scratch record, prepared.
    """
    margin, clear_from = reach
    across, first, edge = (camera.width + 3) >> 2, camera.first_tile, 1 << SQUARE_LEVEL
    bottom, right = pixels.bottom >> 2, pixels.right >> 2
    for sv in range(pixels.top >> 2, bottom + 1, edge):
        for su in range(pixels.left >> 2, right + 1, edge):
            least = texels.trust_squares[SQUARE_LEVEL, first + sv * across + su] >> np.uint32(16)
            half = 2.0 * edge - 0.5
            square = 4.0 * su + half, 4.0 * sv + half, half
            if least >= clear_from or _are_beyond(camera, voxel, square, least, margin):
                continue
            for tv in range(sv, min(sv + edge, bottom + 1)):
                for tu in range(su, min(su + edge, right + 1)):
                    least = texels.trust_tiles[first + tv * across + tu] >> np.uint32(16)
                    square = 4.0 * tu + 1.5, 4.0 * tv + 1.5, 1.5
                    if least >= clear_from or _are_beyond(camera, voxel, square, least, margin):
                        continue
                    part = (
                        max(pixels.top, 4 * tv),
                        min(pixels.bottom, 4 * tv + 3),
                        max(pixels.left, 4 * tu),
                        min(pixels.right, 4 * tu + 3),
                    )
                    if not _is_tile_free(camera, texels, part, reach, voxel):
                        return False
    return True


@uncounted(cache=True, error_model="numpy")
def sees_through_grown(camera, texels, box, voxel):
    """Whether a camera sees through a voxel grown by what anything may have moved since its image.

    Args:
        camera: its record.
        texels: of all cameras, with squares of trust.
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
    if not pixels.whole:
        return False
    if camera.radial:
        px, py, pz = middle
        far = np.sqrt(px * px + py * py + pz * pz) + 0.8660255 * box.edge + grown
    margin = margin_at(camera.margin, far)
    clear_from = np.uint32(min((far + margin) / camera.quantum + 2.0, 65535.0))
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
