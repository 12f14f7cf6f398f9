"""Whether a lens can be that of its image: focal length, principal point, order and reach of its distortion."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.sensing.rectify import IndexMap, index_map_of

VIEW, FOCAL, CENTRE, DISTORTION, WIDE = (
    "field of view",
    "focal length",
    "principal point",
    "distortion",
    "wide lens",
)
WIDEST_DEG, NARROWEST_DEG = 170.0, 10.0
UNEQUAL = 1.3
"""Pixels of depth cameras are square; focal lengths that differ by more are said."""
MIDDLE = (0.25, 0.75)
ALIKE = 0.05
"""A principal point fits another size if both sides ask for the same factor, to this share."""
EXCHANGED = 0.02
"""Off the middle by less than this share, once cx and cy are exchanged."""
IN_THE_MIDDLE, ONE_SIDE = 0.02, 0.12
"""Of the image's side: so near to its middle, and so far from it, cx and cy lie where one side was cut or squeezed."""
FACTORS = (
    0.2,
    0.25,
    1 / 3,
    0.4,
    0.5,
    0.6,
    2 / 3,
    0.75,
    1.5,
    1.6,
    5 / 3,
    2.0,
    2.25,
    2.5,
    3.0,
    4.0,
    5.0,
    6.0,
    8.0,
)
"""By which images are made smaller and larger: 1280 to 640, 1920 to 1280."""
COVERED, USED = 0.9, 0.9
"""Less of the pinhole image, or of the camera's own, is said."""
BETTER = 0.2
TANGENTIAL = 0.05
"""No lens is so decentred; a number like that is a radial one in the wrong place."""
CAMERAS_KEPT = 256


def look_at_lens(camera: DepthCamera) -> list[Finding]:
    """What cannot be meant so of a camera's intrinsics.

    Args:
        camera: of the room.
    """
    findings = list(_focal(camera))
    if any(finding.stops for finding in findings):
        return findings
    findings += _principal_point(camera)
    if camera.intrinsics.is_distorted:
        findings += _distortion(camera)
    return findings


def field_of_view_deg(camera: DepthCamera) -> tuple[float, float]:
    """Of the pinhole, across and down [degrees]."""
    k = camera.intrinsics
    across, down = camera.width / 2 / k.fx, camera.height / 2 / k.fy
    return float(np.degrees(2 * np.arctan(across))), float(np.degrees(2 * np.arctan(down)))


def _focal(camera: DepthCamera) -> Iterator[Finding]:
    k, size = camera.intrinsics, f"{camera.width} x {camera.height} pixels"
    across, down = field_of_view_deg(camera)
    if max(across, down) > WIDEST_DEG:
        unit = (
            f"for an image of size 1: times the image's size fx is {k.fx * camera.width:.4g}, fy "
            f"{k.fy * camera.height:.4g}, "
            f"cx {k.cx * camera.width - 0.5:.4g}, cy {k.cy * camera.height - 0.5:.4g}"
            if 0 <= k.cx <= 1.5 and 0 <= k.cy <= 1.5
            else "in millimetres, or of another image: it must be in pixels of this image"
        )
        text = (
            f"fx {k.fx:g}, fy {k.fy:g} on {size} is a field of view of {max(across, down):.0f} degrees; most "
            "likely the "
            f"intrinsics are {unit}"
        )
        yield Finding(VIEW, (camera.name,), text, stops=True)
        return
    if max(across, down) < NARROWEST_DEG:
        text = (
            f"fx {k.fx:g}, fy {k.fy:g} on {size} is a field of view of {across:.1f} x {down:.1f} degrees; no "
            "depth camera "
            "sees so little: most likely the intrinsics are of a larger image"
        )
        yield Finding(VIEW, (camera.name,), text, stops=max(across, down) < NARROWEST_DEG / 4)
    if max(k.fx, k.fy) > UNEQUAL * min(k.fx, k.fy):
        text = (
            f"fx {k.fx:g} and fy {k.fy:g} differ by a factor of {max(k.fx, k.fy) / min(k.fx, k.fy):.2g}, pixels "
            "would not be "
            "square: check both, and that both belong to this size of image"
        )
        yield Finding(FOCAL, (camera.name,), text, stops=False)


def _principal_point(camera: DepthCamera) -> Iterator[Finding]:
    k = camera.intrinsics
    across, down = (k.cx + 0.5) / camera.width, (k.cy + 0.5) / camera.height
    size = f"cx {k.cx:g}, cy {k.cy:g} in an image of {camera.width} x {camera.height} pixels"
    inside = all(MIDDLE[0] <= share <= MIDDLE[1] for share in (across, down))
    off = _off_middle(across, down)
    exchanged = _off_middle((k.cy + 0.5) / camera.width, (k.cx + 0.5) / camera.height)
    if exchanged < EXCHANGED and off > 3 * exchanged and off > 2 * EXCHANGED:
        text = f"{size}: they look exchanged, cx belongs to the width and cy to the height"
        yield Finding(CENTRE, (camera.name,), text, stops=True)
        return
    factor = across + down  # of the image's size, if the point is in its middle
    alike = abs(across - down) <= ALIKE * max(across, down, 1e-9) and factor > 0.05
    usual = alike and any(abs(factor / each - 1) < ALIKE / 2 for each in FACTORS)
    if inside and not usual:
        one = _of_one_side(camera)
        if one:
            yield Finding(CENTRE, (camera.name,), f"{size}: {one}", stops=False)
        return
    if alike:
        wide, high = round(camera.width * factor), round(camera.height * factor)
        text = (
            f"{size} is not its middle but that of an image of about {wide} x {high}: most likely the intrinsics "
            "are of that "
            f"size; for this one fx is {k.fx / factor:.4g}, fy {k.fy / factor:.4g}, cx "
            f"{(k.cx + 0.5) / factor - 0.5:.4g}, "
            f"cy {(k.cy + 0.5) / factor - 0.5:.4g}"
        )
    else:
        text = (
            f"{size} lies outside the middle half; for an image that was cut out, subtract where the cut begins, "
            "else check "
            "that the intrinsics are of this size of image"
        )
    outside = not (0 <= across <= 1 and 0 <= down <= 1)
    yield Finding(CENTRE, (camera.name,), text, stops=usual or outside)


def _of_one_side(camera: DepthCamera) -> str:
    """What is said where one of cx and cy lies in the middle, and the other clearly not; "": nothing."""
    k = camera.intrinsics
    off = ((k.cx + 0.5) / camera.width - 0.5, (k.cy + 0.5) / camera.height - 0.5)
    middle, odd = sorted(range(2), key=lambda side: abs(off[side]))
    if abs(off[middle]) > IN_THE_MIDDLE or not ONE_SIDE < abs(off[odd]) < 0.5:
        return ""
    name, other, at, side = (("cx", "cy", k.cx, "wide"), ("cy", "cx", k.cy, "high"))[odd]
    return (
        f"{other} is its middle and {name} is not; it is that of an image {2 * at + 1:.0f} pixels {side}: if it was "
        f"cut, subtract where the cut begins from {name}; if it was squeezed, scale {name} and f{name[1]} alike"
    )


def _off_middle(across: float, down: float) -> float:
    return max(abs(across - 0.5), abs(down - 0.5))


def _distortion(camera: DepthCamera) -> Iterator[Finding]:
    k = camera.intrinsics
    covered, used = lens_shares(k, camera.width, camera.height)
    tangential = max(abs(k.distortion[2]), abs(k.distortion[3]))
    if tangential > TANGENTIAL or covered < COVERED:
        words, other = _better_order(camera)
        large = f", and p1, p2 are {k.distortion[2]:g}, {k.distortion[3]:g}, which are below 0.01 for lenses"
        text = (
            f"its lens model covers {covered:.0%} of the image"
            f"{large if tangential > TANGENTIAL else ''}; "
            + (
                f"in the order {words} the coefficients cover {other:.0%}: write them as k1 k2 p1 p2 k3 [k4 k5 "
                "k6], as OpenCV "
                "does"
                if words
                else "check the coefficients, their order (k1 k2 p1 p2 k3 [k4 k5 k6]) and that they are of this "
                "lens; all "
                "beyond is not used"
            )
        )
        yield Finding(DISTORTION, (camera.name,), text, stops=bool(words) or tangential > TANGENTIAL)
    elif used < USED:
        text = (
            f"{1 - used:.0%} of its image is not used: it lies beyond the pinhole image of the same size and "
            "focal length; "
            "the rest of the room is not seen by it"
        )
        yield Finding(WIDE, (camera.name,), text, stops=False)


def _better_order(camera: DepthCamera) -> tuple[str, float]:
    """In which other order the coefficients make a better lens, and what it covers; "" if in none."""
    k = camera.intrinsics
    given = lens_shares(k, camera.width, camera.height)[0]
    c = k.distortion
    orders = (
        {
            "k1 k2 k3 k4 k5 k6 p2 p1": (c[0], c[1], c[7], c[6], c[2], c[3], c[4], c[5]),
            "k1 k2 k3 k4 k5 k6 p1 p2": (c[0], c[1], c[6], c[7], c[2], c[3], c[4], c[5]),
            "k1 k2 k3 p1 p2 k4 k5 k6": (c[0], c[1], c[3], c[4], c[2], c[5], c[6], c[7]),
        }
        if len(c) == 8
        else {
            "k1 k2 k3 p1 p2": (c[0], c[1], c[3], c[4], c[2]),
            "p1 p2 k1 k2 k3": (c[2], c[3], c[0], c[1], c[4]),
        }
    )
    best, words = 0.0, ""
    for name, order in orders.items():
        if max(abs(order[2]), abs(order[3])) > TANGENTIAL:
            continue
        covered = lens_shares(replace(k, distortion=order), camera.width, camera.height)[0]
        if covered > best:
            best, words = covered, name
    tangential = max(abs(c[2]), abs(c[3])) > TANGENTIAL
    return (words, best) if words and best >= (0.8 * given if tangential else given + BETTER) else ("", 0.0)


@lru_cache(maxsize=CAMERAS_KEPT)
def lens_shares(intrinsics: Intrinsics, width: int, height: int) -> tuple[float, float]:
    """What part of the pinhole image the lens model fills, and what part of the camera's own image is used for it.

    Args:
        intrinsics: with distortion.
        width, height: of both images [px].
    """
    index = index_map_of(intrinsics, width, height)
    seen = index.first_u >= 0
    if not seen.any():
        return 0.0, 0.0
    # rectangles of raw pixels, added up by their corners
    corners = np.zeros((height + 1, width + 1), dtype=np.int64)
    for rows, columns, sign in _corners(index, seen):
        np.add.at(corners, (rows, columns), sign)
    used = corners.cumsum(axis=0).cumsum(axis=1)[:height, :width] > 0
    return float(np.mean(seen)), float(np.mean(used))


def _corners(index: IndexMap, seen: NDArray[np.bool_]) -> Iterator[tuple[NDArray, NDArray, int]]:
    first_u, last_u, first_v, last_v = (edge[seen].astype(np.int64) for edge in index)
    yield first_v, first_u, 1
    yield first_v, last_u + 1, -1
    yield last_v + 1, first_u, -1
    yield last_v + 1, last_u + 1, 1
