"""What an image holds at all: nothing, one number, a mask, noise where neighbours should be alike."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.sensing.values.thinned import Thinned

EMPTY, MASK, BYTES, ROUGHNESS, CONSTANT = "no returns", "mask", "byte order", "no surfaces", "constant"
GREATEST_8_BIT = 255
LEAST_UNIT_M = 4e-4
"""Units from here on make 255 of them nearer than sensors measure."""
FEW = 3
ROUGH, SMOOTHER = 0.15, 0.2
"""Neighbours that differ by more than this share (median) are no surfaces; with bytes exchanged, by so much less."""
LEAST_PAIRS = 100


def look_at_content(images: Sequence[Thinned], *, of_all: bool = True) -> list[Finding]:
    """Images without returns or with one number everywhere, masks and 8-bit pictures, bytes in the wrong order.

    Args:
        images: one of each camera.
        of_all: these are all cameras of the room: if none has a return, nothing can be judged.
    """
    empty = [image for image in images if not image.returns.any()]
    findings = [_empty(image, of_all and len(empty) == len(images)) for image in empty]
    for image in images:
        if image.given.any():
            findings += _small_codes(image) or _constant(image) or _rough(image)
    return findings


def _empty(image: Thinned, are_all: bool) -> Finding:
    name = image.camera.name
    if not image.given.any():
        text = "no pixel has a return, all are 0, 65535 or no number: it sees nothing, and disputes what it looks at"
        return Finding(EMPTY, (name,), text, are_all)
    depth = image.here[image.given].astype(float)
    text = (
        f"no pixel has a return from {image.camera.min_depth_m:g} to {image.camera.max_depth_m:g} m, its range; "
        "what it "
        f"delivers is {depth.min():.4g} to {depth.max():.4g} m: check depth_scale_m, min_depth_m and max_depth_m"
    )
    return Finding(EMPTY, (name,), text, are_all)


def _small_codes(image: Thinned) -> list[Finding]:
    """Masks and 8-bit pictures, saved with 16 bits."""
    codes, unit = image.codes, image.unit_m
    if codes is None or unit is None or codes.size < LEAST_PAIRS:
        return []
    different = np.unique(codes)
    if different[-1] > GREATEST_8_BIT or (unit < LEAST_UNIT_M and different.size > FEW):
        return []
    what = (
        f"only the values {', '.join(map(str, different))}: a mask"
        if different.size <= FEW
        else f"values from {different[0]} to {different[-1]}: an 8-bit picture, scaled for the eye"
    )
    text = f"{what}, not depth in units of {unit:g} m. Give the sensor's own 16-bit depth image"
    return [Finding(MASK, (image.camera.name,), text, stops=True)]


def _constant(image: Thinned) -> list[Finding]:
    """One number wherever there is one: what no sensor delivers."""
    depth = image.here[image.given]
    if depth.size < LEAST_PAIRS or depth.min() != depth.max() or image.may_face_a_wall:
        return []
    text = (
        f"each pixel with a depth says exactly {float(depth[0]):.6g} m: no sensor measures so; is this depth?"
    )
    return [Finding(CONSTANT, (image.camera.name,), text, stops=False)]


def _rough(image: Thinned) -> list[Finding]:
    """Neighbours that have nothing in common: bytes in the wrong order, rows out of step, something else than depth."""
    here = np.concatenate([image.here.ravel()] * 2)
    beside = np.concatenate([image.right.ravel(), image.below.ravel()])
    # by what came, whatever the range: wrong bytes reach all over it
    both = (here > 0) & (beside > 0) & (here < np.inf) & (beside < np.inf)
    if np.count_nonzero(both) < LEAST_PAIRS:
        return []
    here, beside = here[both].astype(float), beside[both].astype(float)
    rough = _difference(here, beside)
    if rough < ROUGH:
        return []
    text = f"neighbouring pixels differ by {rough:.0%} (median), as no image of surfaces does"
    unit = image.unit_m
    if unit is not None and _difference(_swapped(here, unit), _swapped(beside, unit)) < SMOOTHER * rough:
        text += "; with their two bytes exchanged they are alike: the file has the other byte order, write it again"
        return [Finding(BYTES, (image.camera.name,), text, stops=True)]
    text += "; check how the file was written: byte order, width and height, that it is depth at all"
    return [Finding(ROUGHNESS, (image.camera.name,), text, stops=True)]


def _difference(here: NDArray[np.float64], beside: NDArray[np.float64]) -> float:
    """Median step between neighbours, as a share of the farther one."""
    return float(np.median(np.abs(here - beside) / np.maximum(np.maximum(here, beside), 1e-12)))


def _swapped(depth: NDArray[np.float64], unit: float) -> NDArray[np.float64]:
    return np.rint(depth / unit).astype(np.uint16).byteswap().astype(float)
