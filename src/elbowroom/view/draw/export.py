"""Free space as files for other programs: NumPy archives and point files."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.atomic import whole_file
from elbowroom.geometry import bits
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.view.draw.palette import COLOURS, Label, labels

POINT = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("red", "u1"),
        ("green", "u1"),
        ("blue", "u1"),
        ("label", "u1"),
    ]
)
"""One vertex of a point file: voxel centre, world frame [m], colour, and `palette.Label`."""


def save_npz(path: Path | str, space: FreeSpace) -> Path:
    """Writes the grid and its planes, to be read by `np.load(path, allow_pickle=False)`.

    Entries: `origin_m` (3,), `shape` (3,), `voxel_size_m` (), and the bool planes `free`, `surface`,
    `unseen`, `blind` and `body` of the grid's shape in index order x, y, z. `blind` is a part of what is
    not free; `body` is what the machine's own body covered.

    Args:
        path: the file, ending in .npz.
        space: what to write.

    Raises:
        InputError: another ending, or a folder that cannot be written to.
    """
    grid = space.grid
    with whole_file(_named(path, ".npz")) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(
            file,
            origin_m=np.array(grid.origin_m),
            shape=np.array(grid.shape),
            voxel_size_m=np.array(grid.voxel_size_m),
            free=space.free,
            surface=space.surface,
            unseen=space.unseen,
            blind=bits.unpack(space.blind_words, grid),
            body=bits.unpack(space.body_words, grid),
        )
    return Path(path)


def save_ply(path: Path | str, space: FreeSpace, *, unseen: bool = True) -> Path:
    """Writes blocked voxels as a binary PLY of coloured points at their centres, world frame [m].

    Args:
        path: the file, ending in .ply.
        space: what to write.
        unseen: whether the border between free and unseen space is written too, beside surfaces and own body.

    Raises:
        InputError: another ending, or a folder that cannot be written to.
    """
    volume = labels(space)
    shown = (volume == Label.SURFACE) | (volume == Label.BODY)
    if unseen:
        shown |= _touches_free(volume)
    index = np.argwhere(shown)
    label = volume[shown]
    points = np.empty(len(index), dtype=POINT)
    for axis, name in enumerate("xyz"):
        points[name] = space.grid.origin_m[axis] + (index[:, axis] + 0.5) * space.grid.voxel_size_m
    table = np.array([COLOURS[one] for one in sorted(Label)], dtype=np.uint8)
    for channel, name in enumerate(("red", "green", "blue")):
        points[name] = table[label, channel]
    points["label"] = label
    with whole_file(_named(path, ".ply")) as unfinished, unfinished.open("wb") as file:
        file.write(_ply_header(len(points), space.grid.voxel_size_m))
        file.write(points.tobytes())
    return Path(path)


def _named(path: Path | str, ending: str) -> Path:
    if Path(path).suffix != ending:
        raise InputError(f"{path}: must be a file name that ends in {ending}")
    return Path(path)


def _ply_header(count: int, voxel_size_m: float) -> bytes:
    words = ", ".join(f"{label.value} {label.name.lower()}" for label in sorted(Label))
    kinds = {"<f4": "float", "|u1": "uchar"}
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment elbowroom: voxel centres in metres, edge {voxel_size_m:g} m; label: {words}",
        f"element vertex {count}",
        *(f"property {kinds[POINT[name].str]} {name}" for name in POINT.names or ()),
        "end_header",
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _touches_free(volume: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Blocked voxels with a free face neighbour."""
    free = volume >= Label.FREE
    near = np.zeros_like(free)
    for axis in range(3):
        lower = [slice(None)] * 3
        upper = [slice(None)] * 3
        lower[axis], upper[axis] = slice(None, -1), slice(1, None)
        near[tuple(lower)] |= free[tuple(upper)]
        near[tuple(upper)] |= free[tuple(lower)]
    return near & ~free
