"""Whether a room lies on its side: no floor at its bottom, but one that stands upright."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.files.mesh.objects import Axis
from elbowroom.simulate.solid import Mesh

Array = NDArray[np.float64]
FLAT = 0.95
"""Cosine within which a face lies level."""
BOTTOM_SHARE, BOTTOM_M = 0.15, 0.3
"""The bottom reaches up so far: a share of the height, and at least so much [m]."""
NO_FLOOR, FLOOR, WALL = 0.3, 0.6, 0.5
"""Shares of the footprint: less at the bottom is no floor, more is one; more at a side is a wall."""
LEVEL_M = 0.02
"""Things that stand on one floor have their bottoms within so much [m]."""
WORDS = ("floor", "ground", "boden", "fussboden", "suelo", "piso", "sol", "pavimento", "vloer")
"""What people call floors."""
LEAST_FLOOR_M = 1.0
"""A floor is so wide [m]; a skirting is not."""
THIN = 0.2
"""An object is a slab if its least extent is at most this share of the others."""


def upright_note(objects: Sequence[tuple[str, Mesh]], up: Axis) -> str | None:
    """What is said of a room on its side; None: nothing.

    Args:
        objects: names and meshes with z up as the file was read.
        up: the file's axis that was taken for up.
    """
    other: Axis = "z" if up == "y" else "y"
    advice = f"if the room lies on its side, say mesh_up: {other} in the site file or --up {other}"
    named = next((name for name, mesh in objects if _is_upright_slab(name, mesh)), None)
    if named is not None:
        return f"{named!r} stands upright; {advice}"
    if _rests(objects):
        return None
    triangles = np.concatenate([mesh.vertices[mesh.faces] for _, mesh in objects])
    # where the file's other axis points now
    way = np.array([0.0, -1.0, 0.0]) if up == "y" else np.array([0.0, 1.0, 0.0])
    if _level_share(triangles, np.array([0.0, 0, 1.0])) >= NO_FLOOR or _level_share(triangles, way) < FLOOR:
        return None
    sides = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]])
    if all(_level_share(triangles, side) > WALL for side in sides):
        return None  # four walls, and a floor that was not modelled
    return f"no floor lies at its bottom, but one stands upright; {advice}"


def _rests(objects: Sequence[tuple[str, Mesh]]) -> bool:
    """Whether most things, and more than one, stand at the bottom, as they do on a floor that was not modelled."""
    bottoms = np.array([mesh.vertices[:, 2].min() for _, mesh in objects if len(mesh.vertices)])
    resting = int((bottoms < bottoms.min() + LEVEL_M).sum())
    return resting > 1 and 2 * resting >= len(bottoms)


def _level_share(triangles: Array, up: Array) -> float:
    """Area of level faces at the bottom, seen along an axis, over that of the footprint."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    twice = np.linalg.norm(normal, axis=1)
    level = np.abs(normal @ up) > FLAT * np.maximum(twice, 1e-12)
    heights = triangles @ up
    low, high = heights.min(), heights.max()
    at_bottom = heights.max(axis=1) < low + max(BOTTOM_SHARE * (high - low), min(BOTTOM_M, (high - low) / 2))
    across = np.ptp(triangles.reshape(-1, 3), axis=0)[np.abs(up) < 0.5]
    return float(twice[level & at_bottom].sum() / 2 / max(float(np.prod(across)), 1e-12))


def _is_upright_slab(name: str, mesh: Mesh) -> bool:
    """A thing called a floor that is thin along x or y."""
    words = "".join(letter.lower() if letter.isalpha() else " " for letter in name).split()
    if not any(word in WORDS for word in words) or not len(mesh.vertices):
        return False
    extent = np.ptp(mesh.vertices, axis=0)
    thin, wide = int(np.argmin(extent)), float(np.partition(extent, 1)[1])
    return thin != 2 and wide >= LEAST_FLOOR_M and float(extent[thin]) <= THIN * wide
