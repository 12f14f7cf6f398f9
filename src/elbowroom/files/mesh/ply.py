"""Stanford polygons (.ply), as text or bytes: one object; it has no unit and says no axis."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.objects import MeshFile, MeshObject
from elbowroom.files.mesh.polygons import strip, triangles_of

KINDS = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_indices", "vertex_index")


@dataclass
class _Element:
    """A list of the file: its rows have these properties; of a list also the kind of its length."""

    name: str
    count: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)


def read_ply(path: Path) -> MeshFile:
    """The surface of a file, in its own unit.

    Raises:
        InputError: not one, or cut short.
    """
    try:
        elements, order, body = _header(path.read_bytes())
        rows = _text(elements, body) if order == "=" else _bytes(elements, body, order)
        vertices = np.column_stack([rows["vertex"][axis] for axis in "xyz"]).astype(np.float64)
        polygons: Any = next((rows["face"][key] for key in CORNERS if key in rows.get("face", {})), [])
        strips: Any = next(
            (rows["tristrips"][key] for key in CORNERS if key in rows.get("tristrips", {})), []
        )
        faces = np.concatenate([_polygons(vertices, polygons), *(_strips(one) for one in strips)])
    except (ValueError, KeyError, IndexError, TypeError) as error:
        raise InputError(f"{path}: damaged PLY ({type(error).__name__}: {error}); export it again") from error
    if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise InputError(f"{path}: a face names vertex {faces.max()} of {len(vertices)}; export it again")
    return MeshFile((MeshObject(path.stem, vertices, faces),) if len(faces) else (), None, None)


def _polygons(vertices: NDArray[np.float64], polygons: Any) -> NDArray[np.int64]:
    if isinstance(polygons, np.ndarray) and polygons.shape[1:] == (3,):
        return polygons.astype(np.int64)
    lists = [np.asarray(one).astype(np.int64).tolist() for one in polygons]
    if any(not 0 <= n < len(vertices) for one in lists for n in one):
        raise ValueError(f"a face names a vertex that is not among {len(vertices)}")
    return triangles_of(vertices, lists)


def _strips(index: Any) -> NDArray[np.int64]:
    """Triangles of strips that are parted by -1."""
    whole = np.asarray(index).astype(np.int64)
    parts = np.split(whole, np.flatnonzero(whole < 0))
    made = [strip(part[part >= 0]) for part in parts if (part >= 0).sum() >= 3]
    return np.concatenate([*made, np.zeros((0, 3), dtype=np.int64)])


def _header(data: bytes) -> tuple[list[_Element], str, bytes]:
    head, end, _ = data.partition(b"end_header")
    if not data.startswith(b"ply") or not end:
        raise ValueError("no header of a PLY file")
    elements: list[_Element] = []
    order = ""
    for words in (line.split() for line in head.decode("ascii", "replace").splitlines()):
        if words[:1] == ["format"]:
            order = ORDERS[words[1]]
        elif words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2])))
        elif words[:2] == ["property", "list"]:
            elements[-1].properties.append((words[4], KINDS[words[3]], KINDS[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1].properties.append((words[2], KINDS[words[1]], None))
    if not order:
        raise ValueError("its format is not said")
    line_end = data.index(b"\n", len(head))
    return elements, order, data[line_end + 1 :]


def _text(elements: list[_Element], body: bytes) -> dict[str, dict[str, Any]]:
    words = iter(body.split())
    found: dict[str, dict[str, Any]] = {}
    try:
        for element in elements:
            rows: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
            for _ in range(element.count):
                for name, _, length in element.properties:
                    if length is None:
                        rows[name].append(float(next(words)))
                    else:
                        rows[name].append([int(next(words)) for _ in range(int(next(words)))])
            found[element.name] = rows
    except StopIteration:
        raise ValueError("it is cut short") from None
    return found


def _bytes(elements: list[_Element], body: bytes, order: str) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    at = 0
    for element in elements:
        alike = _alike(element, body, at, order)
        found[element.name], at = alike if alike is not None else _ragged(element, body, at, order)
    return found


def _alike(element: _Element, body: bytes, at: int, order: str) -> tuple[dict[str, Any], int] | None:
    """All rows at once where lists are all as long as those of the first row; None: they are not."""
    if not element.count:
        return {name: [] for name, _, _ in element.properties}, at
    first, _ = _ragged(_Element(element.name, 1, element.properties), body, at, order)
    fields: list[Any] = []
    for name, kind, length in element.properties:
        if length is None:
            fields.append((name, order + kind))
        else:
            fields += [(f"{name} length", order + length), (name, order + kind, (len(first[name][0]),))]
    row = np.dtype(fields)
    if at + row.itemsize * element.count > len(body):
        return None
    table = np.frombuffer(body, dtype=row, count=element.count, offset=at)
    for name, _, length in element.properties:
        if length is not None and (table[f"{name} length"] != len(first[name][0])).any():
            return None
    return {name: table[name] for name, _, _ in element.properties}, at + row.itemsize * element.count


def _ragged(element: _Element, body: bytes, at: int, order: str) -> tuple[dict[str, Any], int]:
    rows: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
    for _ in range(element.count):
        for name, kind, length in element.properties:
            count = 1
            if length is not None:
                count = int(np.frombuffer(body, dtype=order + length, count=1, offset=at)[0])
                at += np.dtype(length).itemsize
            values = np.frombuffer(body, dtype=order + kind, count=count, offset=at)
            at += values.nbytes
            rows[name].append(values[0] if length is None else values)
    return rows, at
