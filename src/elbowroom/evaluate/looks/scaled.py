"""Focal lengths that are off by some percent, of all cameras alike and of one: from which size on it is said."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from elbowroom.evaluate.looks.scene import Scene
from elbowroom.evaluate.looks.wrong import Change, Wrong
from elbowroom.geometry import DepthCamera
from elbowroom.reconstruct.contradiction.scales import KIND

ALL, ONE = (1.05, 1.1, 1.15, 1.2, 1.25, 0.9, 0.8), (1.1, 1.2, 0.8)
"""By how much too long the site says focal lengths."""
MUCH = 1.18
"""From such a factor on, either way, what is due is due."""


def focal(factor: float, one: bool = False) -> Change:
    """The site says focal lengths so many times the true ones.

    Args:
        factor: above 0.
        one: of one camera, drawn; else of all.
    """

    def change(scene: Scene, rng: np.random.Generator) -> Scene:
        cameras = list(scene.cameras)
        which = [int(rng.integers(len(cameras)))] if one else range(len(cameras))
        for number in which:
            cameras[number] = _scaled(cameras[number], factor)
        return replace(scene, cameras=cameras)

    return change


def _scaled(camera: DepthCamera, factor: float) -> DepthCamera:
    k = camera.intrinsics
    return replace(camera, intrinsics=replace(k, fx=k.fx * factor, fy=k.fy * factor))


def is_much(kind: str) -> bool:
    """Whether a kind is as far off as is told in most rooms."""
    factor = _FACTORS[kind]
    return max(factor, 1 / factor) >= MUCH


_FACTORS = {
    **{f"focal length times {factor:g}, all": factor for factor in ALL},
    **{f"focal length times {factor:g}, one": factor for factor in ONE},
}
SCALED: Mapping[str, Wrong] = {
    name: Wrong(focal(factor, one=name.endswith("one")), (KIND,)) for name, factor in _FACTORS.items()
}
"""By name."""
