"""The geometries of a Collada file as triangles."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.polygons import fan, strip, triangles_of

Array = NDArray[np.float64]
Element = ElementTree.Element
Shape = tuple[Array, NDArray[np.int64]]
SURFACES = ("triangles", "polylist", "polygons", "trifans", "tristrips")


def shape_of(path: Path, geometry: Element) -> Shape:
    """Vertices, shape (n, 3), and faces, shape (m, 3), of a geometry in its own frame; lines of it are no surface.

    Raises:
        InputError: it is no mesh, or a part of it cannot be read; names the geometry.
    """
    name = geometry.get("name") or geometry.get("id") or "geometry"
    what = f"{path}: geometry {name!r}"
    mesh = geometry.find("mesh")
    if mesh is None:
        kinds = ", ".join(child.tag for child in geometry if child.tag not in ("asset", "extra"))
        raise InputError(f"{what}: is no mesh ({kinds or 'empty'}); export it as triangles")
    vertices, faces, before = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for part in mesh:
        if part.tag not in SURFACES:
            continue
        corners, offset, width = _corners(mesh, part, what)
        own = _faces(part, corners, offset, width, what)
        if len(own) and (own.min() < 0 or own.max() >= len(corners)):
            raise InputError(f"{what}: a face names vertex {own.max()} of {len(corners)}; export it again")
        vertices.append(corners)
        faces.append(own + before)
        before += len(corners)
    return np.concatenate(vertices), np.concatenate(faces)


def _corners(mesh: Element, part: Element, what: str) -> tuple[Array, int, int]:
    """Positions that a part's corners name, at which of the numbers of a corner, of how many."""
    inputs = part.findall("input")
    width = max((int(one.get("offset", "0")) for one in inputs), default=0) + 1
    for one in inputs:
        if one.get("semantic") == "VERTEX":
            vertices = _of_id(mesh, one.get("source", ""), what)
            for position in vertices.findall("input"):
                if position.get("semantic") == "POSITION":
                    source = _of_id(mesh, position.get("source", ""), what)
                    return _rows(source, what), int(one.get("offset", "0")), width
    raise InputError(f"{what}: its faces have no positions; export it again")


def _of_id(mesh: Element, url: str, what: str) -> Element:
    for element in mesh:
        if element.get("id") == url[1:]:
            return element
    raise InputError(f"{what}: {url} is not in it; export it again")


def _rows(source: Element, what: str) -> Array:
    """The x, y, z of a source, shape (n, 3)."""
    array, accessor = source.find("float_array"), source.find("technique_common/accessor")
    if array is None or accessor is None:
        raise InputError(f"{what}: its positions are no list of numbers; export it again")
    numbers = np.array((array.text or "").split(), dtype=np.float64)
    count, stride = int(accessor.get("count", "0")), int(accessor.get("stride", "1"))
    offset = int(accessor.get("offset", "0"))
    if stride < 3 or offset + count * stride > len(numbers):
        raise InputError(f"{what}: {len(numbers)} numbers for {count} positions of {stride}; export it again")
    return numbers[offset : offset + count * stride].reshape(count, stride)[:, :3]


def _faces(part: Element, corners: Array, offset: int, width: int, what: str) -> NDArray[np.int64]:
    if part.find("ph") is not None:
        raise InputError(f"{what}: has polygons with holes (<ph>); export it as triangles")
    lists = [_whole(element)[offset::width] for element in part.findall("p")]
    if part.tag == "triangles":
        index = np.concatenate([*lists, np.zeros(0, dtype=np.int64)])
        if len(index) % 3:
            raise InputError(f"{what}: {len(index)} corners make no whole triangles; export it again")
        return index.reshape(-1, 3)
    if part.tag in ("trifans", "tristrips"):
        made = [strip(one) if part.tag == "tristrips" else fan(one[None]) for one in lists if len(one) >= 3]
        return np.concatenate([*made, np.zeros((0, 3), dtype=np.int64)])
    polygons: Sequence[NDArray[np.int64]] = lists
    if part.tag == "polylist":
        index = np.concatenate([*lists, np.zeros(0, dtype=np.int64)])
        counts = _whole(part.find("vcount"))
        if counts.sum() != len(index):
            raise InputError(f"{what}: {len(index)} corners for polygons of {counts.sum()}; export it again")
        polygons = np.split(index, np.cumsum(counts)[:-1]) if len(counts) else []
    if any(len(one) and (one.min() < 0 or one.max() >= len(corners)) for one in polygons):
        raise InputError(f"{what}: a face names a vertex that is not there; export it again")
    return triangles_of(corners, [one.tolist() for one in polygons])


def _whole(element: Element | None) -> NDArray[np.int64]:
    text = "" if element is None else element.text or ""
    return np.array(text.split(), dtype=np.int64)
