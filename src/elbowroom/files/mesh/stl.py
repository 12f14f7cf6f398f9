"""STL, as bytes or in letters: its solids; it has no unit and says no axis."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.content import head_of
from elbowroom.files.mesh.objects import MeshFile, MeshObject, named_apart

HEAD_BYTES, TRIANGLE_BYTES = 84, 50
"""Of a file in bytes: what stands before its triangles, and each of them."""
_SOLID = re.compile(rb"^[ \t]*solid\b((?:(?!(?<!\S)facet\s+normal\s)[^\r\n])*)", re.MULTILINE | re.IGNORECASE)
_END = re.compile(rb"^[ \t]*end[ \t]*solid\b[^\r\n]*", re.MULTILINE | re.IGNORECASE)
_BEGUN = re.compile(rb"(?<!\S)facet(?!\S)", re.IGNORECASE)
_CORNER = rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)\s+"
_FACET = re.compile(
    rb"(?<!\S)facet\s+(?:(?!outer\b)\S+\s+)*outer\s+loop\s+" + 3 * _CORNER + rb"endloop\s+endfacet(?!\S)",
    re.IGNORECASE,
)


def read_stl(path: Path) -> MeshFile:
    """The solids of a file, in its own unit; each triangle has corners of its own.

    Raises:
        InputError: it holds other triangles than it says, or one that cannot be read.
    """
    size, head = path.stat().st_size, head_of(path)
    count = int.from_bytes(head[80:84], "little")
    if size >= HEAD_BYTES and size == HEAD_BYTES + TRIANGLE_BYTES * count:
        return _of_bytes(path, count)
    if b"\0" not in head:
        return _of_letters(path)
    if size < HEAD_BYTES:
        raise InputError(f"{path}: has {size} bytes, fewer than the head of an STL")
    holds = (size - HEAD_BYTES) / TRIANGLE_BYTES
    raise InputError(
        f"{path}: says that it has {count:,} triangles, and its {size:,} bytes hold {holds:,.1f}: "
        f"{'it was cut off' if holds < count else 'more follows, or its count was never written'}; export it anew"
    )


def _of_bytes(path: Path, count: int) -> MeshFile:
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.fromfile(path, triangle, count, offset=HEAD_BYTES)["corners"].astype(np.float64)
    return MeshFile((_solid(path.stem, corners),) if count else (), None, None)


def _of_letters(path: Path) -> MeshFile:
    content = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    found = [(name, _facets(path, part)) for name, part in _solids(content)]
    found = [(name, corners) for name, corners in found if len(corners)]
    if len(found) == 1:
        found = [(path.stem, found[0][1])]
    names = named_apart([name or path.stem for name, _ in found])
    solids = [_solid(own, corners) for own, (_, corners) in zip(names, found, strict=True)]
    notes = []
    if solids and not _END.search(content, content.lower().rfind(b"endfacet")):
        notes.append("its last endsolid is missing: was it cut off?")
    return MeshFile(tuple(sorted(solids, key=lambda one: one.name)), None, None, tuple(notes))


def _solids(content: bytes) -> Iterator[tuple[str, bytes]]:
    """Name and text of each solid, whether or not it ends; what stands before the first has no name."""
    begins = list(_SOLID.finditer(content))
    yield "", content[: begins[0].start() if begins else len(content)]
    ends = [*(begin.start() for begin in begins), len(content)][1:]
    for begin, end in zip(begins, ends, strict=True):
        yield begin[1].decode("utf-8", "replace").strip(), content[begin.end() : end]


def _facets(path: Path, solid: bytes) -> NDArray[np.float64]:
    """Corners of a solid's triangles, shape (n, 3, 3)."""
    solid = _END.sub(b"", solid)
    begun, found = len(_BEGUN.findall(solid)), _FACET.findall(solid)
    if begun != len(found):
        raise InputError(
            f"{path}: begins {begun:,} triangles, of which {len(found):,} are whole; export it anew"
        )
    try:
        return np.array(found, dtype=bytes).astype(np.float64).reshape(-1, 3, 3)
    except ValueError as error:
        raise InputError(f"{path}: a corner cannot be read ({error}); export it anew") from None


def _solid(name: str, corners: NDArray[np.float64]) -> MeshObject:
    return MeshObject(name, corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
