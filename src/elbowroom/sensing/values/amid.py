"""One exact number amid others that several cameras have in common: what a driver writes where there was no return."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from elbowroom.finding import Finding
from elbowroom.sensing.values.scatter import scatter_of
from elbowroom.sensing.values.sentinel import JOINED, KIND, LEAST_PIXELS, SHARE, joined
from elbowroom.sensing.values.thinned import Thinned

OVER_NEXT = 8
"""So many times as often as the values next to it: sensors scatter, so a surface fills neighbours as well."""
LEAST_NOISE_M = 3e-4
"""Depths that scatter by less have no noise [m]."""
NEXT = 3
"""So many values on either side are looked at."""


def look_amid(images: Sequence[Thinned], findings: Sequence[Finding]) -> list[Finding]:
    """Numbers that are no surface, also where others are greater; it stops, for all before them would read free.

    Sensors give no exact number that fills a part of an image, stands alone among the values next to it, and ends
    everywhere at a step; least of all two of them the same. Images without noise do, of what a camera faces: they are
    not looked at.

    Args:
        images: one of each camera.
        findings: of them so far; a number is not named twice.
    """
    named = {name for finding in findings if finding.kind == KIND for name in finding.about}
    looked = [image for image in images if image.camera.name not in named]
    alone = {image.camera.name: _alone(image) for image in looked}
    cameras: dict[float, list[str]] = {}
    for name, shares in alone.items():
        for value in shares:
            cameras.setdefault(value, []).append(name)
    return [
        Finding(KIND, (name,), _text(value, alone[name][value]), stops=True)
        for value, names in cameras.items()
        if len(names) > 1
        for name in names
    ]


def _alone(image: Thinned) -> Mapping[float, float]:
    """Shares of the pixels by value, of those that are no surface."""
    values, counts = np.unique(image.here[image.returns], return_counts=True)
    found = {}
    for at in np.flatnonzero(counts >= max(SHARE * image.here.size, LEAST_PIXELS)):
        beside = np.concatenate([counts[max(at - NEXT, 0) : at], counts[at + 1 : at + 1 + NEXT]])
        is_alone = counts[at] > OVER_NEXT * beside.max(initial=0) and joined(image, values[at]) < JOINED
        if is_alone and _scatters(image, values[at]):
            found[round(float(values[at]), 5)] = float(counts[at]) / image.here.size
    return found


def _scatters(image: Thinned, value: np.float32) -> bool:
    """Whether all but a value is measured, with a sensor's noise."""
    scatter = scatter_of(replace(image, here=np.where(image.here == value, np.float32(0), image.here)))
    return scatter is not None and scatter[0] > LEAST_NOISE_M


def _text(value_m: float, share: float) -> str:
    return (
        f"{share:.0%} of the pixels are exactly {value_m:.6g} m, as in another camera's image, and no surface leads up "
        "to them: most likely what the driver writes where there is no return, and all before it would read free. "
        "Write 0 there"
    )
