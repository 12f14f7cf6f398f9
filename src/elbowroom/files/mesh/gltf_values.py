"""Numbers of a glTF file: its accessors as arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.gltf_file import COMPRESSED, GltfFile

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4", 5130: "<f8"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def values(file: GltfFile, number: int, what: str) -> NDArray[Any]:
    """An accessor's numbers, sparse ones put in their places, shape (count, width).

    Args:
        file: whose it is.
        number: of the accessor.
        what: it is for, in messages, such as "mesh 'A'".

    Returns:
        float64 where numbers are fractions or stand for some (normalised), else of their own kind.

    Raises:
        InputError: the file has not all of them; names what they are for.
    """
    try:
        return _values(file, number, what)
    except (IndexError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{file.path}: {what}: accessor {number} cannot be read ({type(error).__name__}: {error}); export it again"
        ) from None


def _values(file: GltfFile, number: int, what: str) -> NDArray[Any]:
    accessor = file.listed("accessors")[number]
    kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
    count = int(accessor["count"])
    if "bufferView" in accessor:
        offset = int(accessor.get("byteOffset", 0))
        found = _viewed(file, accessor["bufferView"], offset, (count, width), kind, what)
    else:
        found = np.zeros((count, width), dtype=kind)
    sparse = accessor.get("sparse")
    if sparse is not None:
        few = int(sparse["count"])
        at, put = sparse["indices"], sparse["values"]
        index = _viewed(
            file,
            at["bufferView"],
            int(at.get("byteOffset", 0)),
            (few, 1),
            np.dtype(COMPONENTS[at["componentType"]]),
            what,
        )
        found[index[:, 0]] = _viewed(
            file, put["bufferView"], int(put.get("byteOffset", 0)), (few, width), kind, what
        )
    if kind.kind == "f":
        return found.astype(np.float64)
    return _fractions(found) if accessor.get("normalized") else found


def _fractions(whole: NDArray[Any]) -> NDArray[np.float64]:
    """What normalised whole numbers stand for: 0 to 1, or -1 to 1."""
    return np.maximum(whole.astype(np.float64) / np.iinfo(whole.dtype).max, -1.0)


def _viewed(
    file: GltfFile, number: int, offset: int, shape: tuple[int, int], kind: np.dtype[Any], what: str
) -> NDArray[Any]:
    view = file.listed("bufferViews")[number]
    buffer = file.buffers[view["buffer"]]
    if buffer is None:
        packed = [name for name in COMPRESSED if name in (view.get("extensions") or {})]
        raise InputError(
            f"{file.path}: {what}: its shape is packed ({', '.join(packed) or 'compression'}) and not there unpacked; "
            "export it without compression"
        )
    begin, length = int(view.get("byteOffset", 0)), int(view["byteLength"])
    item = shape[1] * kind.itemsize
    stride = int(view.get("byteStride") or item)
    if offset < 0 or begin < 0 or begin + length > len(buffer):
        raise ValueError("it lies beyond its buffer")
    if shape[0] and offset + (shape[0] - 1) * stride + item > length:
        raise ValueError("it is cut short")
    if not shape[0]:
        return np.zeros(shape, dtype=kind)
    raw = np.frombuffer(buffer, dtype=np.uint8, count=length - offset, offset=begin + offset)
    rows = np.lib.stride_tricks.as_strided(raw, (shape[0], item), (stride, 1))
    return np.ascontiguousarray(rows).view(kind).reshape(shape).copy()
