"""References on disk: one .npz file beside the site file. Nothing in it is unpickled, and sizes are checked first."""

import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from elbowroom.errors import CalibrationError
from elbowroom.monitor.health.drift.reference import CameraReference

VERSION = 1
MAX_BYTES = 50_000_000
MAX_CAMERAS = 1000
COLUMNS = {"version": (), "names": (None,), "images": (None, 3), "lenses": (None, 12), "counts": (None,)}
SPOTS = {"pixel": (None,), "depth_m": (None,), "sigma_m": (None,), "ray": (None, 2), "normal": (None, 3)}
"""Shape of each array; the first five tell of cameras, the others of spots, one camera after the other."""


def save_references(references: Sequence[CameraReference], path: Path) -> None:
    """Writes references of all cameras of a room.

    Args:
        references: at least one.
        path: of the file, which becomes whole at once or not at all where the caller sees to that.
    """
    arrays: dict[str, np.ndarray] = {
        "version": np.array(VERSION),
        "names": np.array([reference.camera for reference in references]),
        "images": np.array([(r.width, r.height, int(r.radial)) for r in references], dtype=np.int64),
        "lenses": np.array([r.lens for r in references], dtype=np.float64),
        "counts": np.array([len(r.pixel) for r in references], dtype=np.int64),
        **{name: np.concatenate([getattr(r, name) for r in references]) for name in SPOTS},
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w") as file:
                npy.write_array(file, array, allow_pickle=False)


def load_references(path: Path) -> tuple[CameraReference, ...]:
    """Reads what `save_references` wrote.

    Raises:
        CalibrationError: missing, too large, no such file, another version, or arrays that do not fit each other.
    """
    if not path.is_file():
        raise CalibrationError(f"no reference {path}; `elbowroom calibrate commission` makes one")
    if path.stat().st_size > MAX_BYTES:
        raise CalibrationError(
            f"{path}: {path.stat().st_size:,} bytes, a reference has at most {MAX_BYTES:,}"
        )
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {name: _array(archive, name, path) for name in (*COLUMNS, *SPOTS)}
    except (zipfile.BadZipFile, KeyError, ValueError, OSError, EOFError) as error:
        what = " ".join(str(error).split())
        raise CalibrationError(f"{path}: no reference ({what}); commission the site again") from None
    _require_fit(arrays, path)
    counts = arrays["counts"]
    ends = np.cumsum(counts)
    try:
        return tuple(
            _reference(arrays, number, slice(end - count, end))
            for number, (end, count) in enumerate(zip(ends, counts, strict=True))
        )
    except CalibrationError as error:
        raise CalibrationError(f"{path}: {error}") from None


def _require_fit(arrays: dict[str, np.ndarray], path: Path) -> None:
    """Refuses another version, and arrays that do not fit each other."""
    if arrays["version"] != VERSION:
        raise CalibrationError(
            f"{path}: version {arrays['version']}, this program reads {VERSION}; commission again"
        )
    counts = arrays["counts"]
    cameras, spots = len(counts), len(arrays["pixel"])
    fits = all(len(arrays[name]) == cameras for name in COLUMNS if name != "version")
    fits &= all(len(arrays[name]) == spots for name in SPOTS)
    if not fits or not 1 <= cameras <= MAX_CAMERAS or (counts < 0).any() or counts.sum() != spots:
        raise CalibrationError(f"{path}: its arrays do not fit each other; commission the site again")


def _array(archive: zipfile.ZipFile, name: str, path: Path) -> np.ndarray:
    """One array; its header is read, and its size compared, before memory is taken."""
    shape, member = {**COLUMNS, **SPOTS}[name], archive.getinfo(f"{name}.npy")
    if member.file_size > MAX_BYTES:
        raise CalibrationError(
            f"{path}: {name} of {member.file_size:,} bytes, at most {MAX_BYTES:,} are read"
        )
    with archive.open(member) as file:
        array: np.ndarray = npy.read_array(file, allow_pickle=False)
    wanted = "U" if name == "names" else "i" if name in ("version", "images", "counts", "pixel") else "f"
    if array.dtype.kind != wanted or len(array.shape) != len(shape) or array.shape[1:] != shape[1:]:
        raise CalibrationError(
            f"{path}: {name} is {array.dtype} of shape {array.shape}; commission the site again"
        )
    return array


def _reference(arrays: dict[str, np.ndarray], number: int, spots: slice) -> CameraReference:
    width, height, radial = (int(value) for value in arrays["images"][number])
    return CameraReference(
        camera=str(arrays["names"][number]),
        width=width,
        height=height,
        lens=tuple(float(value) for value in arrays["lenses"][number]),
        radial=bool(radial),
        **{name: arrays[name][spots] for name in SPOTS},
    )
