"""Whether a room's mesh has the size of a room, and which unit it most likely has where it has not."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.simulate.solid import Mesh

LARGEST_M = 100.0
"""An object that is longer was not modelled in metres [m]."""
LARGEST_ROOM_M = 300.0
"""A room that is longer was not, either [m]."""
SMALLEST_M = 0.2
"""A whole room that is smaller was not modelled in metres [m]."""
MOST_BOXES = 30.0
"""A room so many times as long and as wide as the watched box was not, either."""
USUAL_M = 5.0
"""Length of a room where no box is known [m]."""
UNITS = {"millimetres": 0.001, "centimetres": 0.01, "inches": 0.0254, "feet": 0.3048}
SMALLER = (1000.0, 100.0, 1 / 0.0254, 10.0)
"""Factors by which rooms are made too small."""
FITS = (np.array([0.7, 0.7, 0.35]), 1.4)
"""A room in another unit is taken for one in it that is so many boxes long, wide and high."""

Named = Sequence[tuple[str, Mesh]]


def require_size(path: Path, objects: Named, metres: float, box_m: NDArray[np.float64] | None) -> None:
    """Refuses what no room is.

    Args:
        path: of the file.
        objects: names and meshes, world frame [m].
        metres: what one unit of the file was taken for [m].
        box_m: the watched box, shape (2, 3) [m]; None: not known.

    Raises:
        InputError: an object or the whole is too large or too small; says the factor that would fit.
    """
    sizes = {name: float(np.ptp(mesh.vertices, axis=0).max()) for name, mesh in objects if len(mesh.vertices)}
    whole = _extent(objects)
    longest = max(sizes, key=lambda name: sizes[name])
    boxes = np.zeros(3) if box_m is None else whole / np.ptp(box_m, axis=0)
    usual = USUAL_M if box_m is None else float(np.ptp(box_m, axis=0).max())
    if sizes[longest] > LARGEST_M:
        what = f"object {longest!r} is {sizes[longest]:,.0f} m long"
    elif whole.max() > LARGEST_ROOM_M:
        what = f"all of it is {whole.max():,.0f} m long"
    elif np.sort(boxes)[1] > MOST_BOXES:
        what = f"all of it is {np.sort(boxes)[1]:.0f} times as wide as the watched box"
    elif whole.max() < SMALLEST_M:
        factor = min(SMALLER, key=lambda one: abs(np.log(whole.max() * one / usual)))
        raise InputError(
            f"{path}: all of it is only {whole.max():.3g} m long; {_advice(factor, metres, None)}"
        )
    else:
        return
    unit = min(UNITS, key=lambda one: _unlikely(whole.max() * UNITS[one] / usual))
    raise InputError(f"{path}: {what}; {_advice(UNITS[unit], metres, unit)}")


def unit_note(objects: Named, metres: float, box_m: NDArray[np.float64]) -> str | None:
    """What is said where the mesh is far larger than the box, and would fit it in another unit; None: nothing.

    Args:
        objects: names and meshes, world frame [m].
        metres: what one unit of the file was taken for [m].
        box_m: the watched box, shape (2, 3) [m].
    """
    whole, box = _extent(objects), np.ptp(box_m, axis=0)
    for unit, factor in UNITS.items():
        share = whole * factor / box
        if (share > FITS[0]).all() and (share < FITS[1]).all():
            size, watched = (" x ".join(f"{length:.1f}" for length in lengths) for lengths in (whole, box))
            return f"is {size} m about a box of {watched} m; if it is in {unit}, {_option(factor * metres)}"
    return None


def _unlikely(share: float) -> float:
    """Of a room so many times as long as usual: furniture alone is shorter, hardly anything is longer."""
    return float(np.log(share) * 2 if share > 1 else -np.log(share))


def _extent(objects: Named) -> NDArray[np.float64]:
    return np.asarray(np.ptp(np.concatenate([mesh.vertices for _, mesh in objects]), axis=0))


def _advice(factor: float, metres: float, unit: str | None) -> str:
    looks = f"this looks like {unit}: " if unit and metres == 1.0 else "it was not modelled in that unit: "
    return f"{looks}{_option(factor * metres)}, or scale the room by {factor:.4g} and export it again"


def _option(metres: float) -> str:
    return f"say mesh_unit_m: {metres:.4g} in the site file or --unit {metres:.4g}"
