"""The places of an empty room that the cameras see worst, in words."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from elbowroom.placement.verification import Verification

MOST_NAMES = 3
BLOCK_M = 0.5
"""What more cameras see is told in boxes of at most this edge, or it would be one place all along the walls [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Voxels that hang together and fail in the same way.

    Args:
        lower_m, upper_m: the box about them, shape (3,), world frame [m].
        voxels: how many.
        apart: size of the largest set of views far enough apart, of each of them.
        cameras: those that see at least one of them; where no more than three see any, exactly these see all of them.
        words: where it is and who sees it.
    """

    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]
    voxels: int
    apart: int
    cameras: tuple[str, ...]
    words: str

    def row(self) -> dict[str, Any]:
        """Where it is, in words and numbers."""
        return {
            "words": self.words,
            "lower_m": self.lower_m,
            "upper_m": self.upper_m,
            "voxels": self.voxels,
            "apart": self.apart,
            "cameras": self.cameras,
        }


def worst_places(found: Verification, most: int = 5) -> list[Place]:
    """Places that fail, those with the fewest views first, and of these the largest.

    Voxels belong together if they share a face, have as many views that are far enough apart, and are seen by the same
    cameras where these are no more than three, else lie in one cube of half a metre.

    Args:
        found: what was verified.
        most: so many places at most.
    """
    places: list[Place] = []
    failing = found.asked & ~found.valid
    for apart in range(found.requirement.views):
        level = failing & (found.apart == apart)
        if not level.any():
            continue
        parts = [part for piece in _pieces(found, level) for part in _parts(*piece)]
        parts.sort(key=lambda part: -int(part[1].sum()))
        places += [_place(found, corner, mask, apart) for corner, mask in parts[: most - len(places)]]
        if len(places) >= most:
            break
    return places


def _pieces(found: Verification, level: NDArray[np.bool_]) -> list["Piece"]:
    """Voxels seen by the same few cameras, each kind as one; all that more cameras see in blocks."""
    many = level & (found.counts > MOST_NAMES)
    few = level & ~many
    pieces = _blocks(many, max(1, round(BLOCK_M / found.grid.voxel_size_m))) if many.any() else []
    index = np.argwhere(few)
    if len(index):
        by_camera = np.packbits(found.seen[:, few], axis=0)
        _, kind = np.unique(by_camera, axis=1, return_inverse=True)
        for number in range(int(kind.max()) + 1):
            mask = np.zeros_like(level)
            mask[tuple(index[np.ravel(kind) == number].T)] = True
            pieces.append((np.zeros(3, dtype=np.int64), mask))
    return pieces


Piece = tuple[NDArray[np.int64], NDArray[np.bool_]]
"""First index of a part of the grid, and which of its voxels are meant."""


def _blocks(mask: NDArray[np.bool_], edge: int) -> list[Piece]:
    """The mask cut into cubes of so many voxels; empty ones are left out."""
    pieces = []
    for corner in np.ndindex(*(-(-n // edge) for n in mask.shape)):
        part = mask[tuple(slice(c * edge, (c + 1) * edge) for c in corner)]
        if part.any():
            pieces.append((np.array(corner) * edge, part))
    return pieces


def _parts(corner: NDArray[np.int64], mask: NDArray[np.bool_]) -> list[Piece]:
    """Pieces that hang together."""
    numbered, count = ndimage.label(mask)
    return [
        (corner + [span.start for span in place], numbered[place] == number + 1)
        for number, place in enumerate(ndimage.find_objects(numbered, count))
        if place is not None
    ]


def _place(found: Verification, corner: NDArray[np.int64], mask: NDArray[np.bool_], apart: int) -> Place:
    grid = found.grid
    lower = grid.lower_m + corner * grid.voxel_size_m
    upper = lower + np.array(mask.shape) * grid.voxel_size_m
    span = tuple(slice(first, first + n) for first, n in zip(corner, mask.shape, strict=True))
    seeing = [bool(seen[span][mask].any()) for seen in found.seen]
    names = tuple(camera.name for camera, sees in zip(found.cameras, seeing, strict=True) if sees)
    most = int(found.counts[span][mask].max())
    words = f"{_where(found, lower, upper)}: {_who(names, most, apart, found)}"
    share = int(mask.sum()) / mask.size
    if share < 0.6:
        words += f" ({share:.0%} of this box)"
    return Place(lower, upper, int(mask.sum()), apart, names, words)


def _where(found: Verification, lower: NDArray[np.float64], upper: NDArray[np.float64]) -> str:
    """The box, a side that reaches the grid's edge left out where the other does not."""
    texts = []
    for axis, name in enumerate("xyz"):
        low, high = lower[axis], upper[axis]
        at_floor = low <= found.grid.lower_m[axis] + 1e-9
        at_top = high >= found.grid.upper_m[axis] - 1e-9
        if at_floor and at_top:
            texts.append(f"any {name}")
        elif at_floor and axis == 2:
            texts.append(f"below {_number(high)} m")
        elif at_top and axis == 2:
            texts.append(f"above {_number(low)} m")
        elif high - low < 1.5 * found.grid.voxel_size_m:
            texts.append(f"{name} {_number((low + high) / 2)}")
        else:
            texts.append(f"{name} {_number(low)} to {_number(high)}")
    return ", ".join(texts)


def _number(value: float) -> str:
    return f"{round(float(value), 2) + 0.0:g}"


def _who(names: tuple[str, ...], most: int, apart: int, found: Verification) -> str:
    if not names:
        return "nobody sees it"
    if most <= MOST_NAMES:
        listed = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
        sees = "sees" if len(names) == 1 else "see"
        too_near = len(names) > 1 and most >= found.requirement.views
        return f"only {listed} {sees} it" + (", too near to each other" if too_near else "")
    wanted = found.requirement
    enough = f"no {wanted.views} are {wanted.angle_deg:g} degrees apart (at most {apart})"
    return f"up to {most} cameras see it, but {enough}"
