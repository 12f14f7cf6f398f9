"""Collada (.dae): the triangles of a file's scene. Pictures, lights and materials are passed over.

The file's `<unit>` is obeyed and its `<up_axis>` is not: so RViz, MoveIt, Gazebo and Pinocchio read the meshes of a
URDF, and robots are drawn to look right there.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree
from numpy.typing import NDArray
from trimesh import transformations

from elbowroom.errors import MachineError
from elbowroom.machine.description.report import first_entity

DEEPEST = 64
"""Nodes within nodes; a file that goes deeper leads in a ring."""
NO_SURFACE = {"lines", "linestrips"}
"""Primitives without a surface."""

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]


class Scene(NamedTuple):
    """Triangles of a file.

    Args:
        vertices: shape (n, 3) [m], axes as in the file.
        faces: shape (m, 3).
        up_axis: what the file says is up: "X_UP", "Y_UP" or "Z_UP".
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    up_axis: str


def read_collada(path: Path) -> Scene:
    """All triangles of a file's scene, in metres.

    Raises:
        MachineError: not Collada, a reference to nothing, a part that cannot be read; the message names the line.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True)
    try:
        root = etree.fromstring(path.read_bytes().lstrip(), parser)
    except etree.XMLSyntaxError as error:
        raise MachineError(f"mesh {path}: not XML: {error}") from error
    if etree.QName(root).localname != "COLLADA":
        raise MachineError(f"mesh {path}: the outermost element is not <COLLADA>")
    entity = first_entity(root)
    if entity is not None:
        raise MachineError(
            f"mesh {path}: line {entity.sourceline}: {entity.text} stands for other text (an XML entity), which is not "
            "read: put its content there"
        )
    return _Reader(path, root).scene()


class _Reader:
    """One file: its elements by id, and how their errors are named."""

    def __init__(self, path: Path, root: etree._Element) -> None:
        self.path, self.root = path, root
        self.by_id = {element.get("id"): element for element in root.iter(etree.Element) if element.get("id")}
        self.made: dict[str, Triangles] = {}

    def scene(self) -> Scene:
        vertices: list[NDArray[np.float64]] = [np.zeros((0, 3))]
        faces: list[NDArray[np.int64]] = [np.zeros((0, 3), dtype=np.int64)]
        count = 0
        for transform, geometry in self._instances():
            points, triangles = self._geometry(geometry)
            if np.linalg.det(transform[:3, :3]) < 0:
                triangles = triangles[:, ::-1]
            vertices.append(points @ transform[:3, :3].T + transform[:3, 3])
            faces.append(triangles + count)
            count += len(points)
        unit = self.root.find("{*}asset/{*}unit")
        meter = 1.0 if unit is None else self._floats(unit, unit.get("meter") or "1", 1)[0]
        if not (np.isfinite(meter) and meter > 0):
            raise self._error(unit, f"a unit of {meter:g} m")
        up_axis = (self.root.findtext("{*}asset/{*}up_axis") or "Y_UP").strip()
        return Scene(np.concatenate(vertices) * meter, np.concatenate(faces), up_axis)

    def _error(self, element: etree._Element | None, text: str) -> MachineError:
        line = "" if element is None else f"line {element.sourceline}: <{etree.QName(element).localname}>: "
        return MachineError(f"mesh {self.path}: {line}{text}")

    def _target(self, element: etree._Element, name: str) -> etree._Element:
        """The element that a reference names."""
        url = element.get(name) or ""
        found = self.by_id.get(url.removeprefix("#")) if url.startswith("#") else None
        if found is None:
            raise self._error(element, f"{name}={url!r} names nothing in this file")
        return found

    def _instances(self) -> Iterator[tuple[NDArray[np.float64], etree._Element]]:
        """Each geometry of the scene, with where it is; without a scene, all geometries as they stand."""
        shown = self.root.find("{*}scene/{*}instance_visual_scene")
        scene = self.root.find("{*}library_visual_scenes/{*}visual_scene")
        if shown is not None:
            scene = self._target(shown, "url")
        if scene is None:
            for geometry in self.root.iterfind("{*}library_geometries/{*}geometry"):
                yield np.eye(4), geometry
            return
        for node in scene.iterfind("{*}node"):
            yield from self._node(node, np.eye(4), 0)

    def _node(
        self, node: etree._Element, above: NDArray[np.float64], depth: int
    ) -> Iterator[tuple[NDArray[np.float64], etree._Element]]:
        if depth > DEEPEST:
            raise self._error(node, "nodes lead in a ring")
        here = above
        for child in node.iterchildren(etree.Element):
            make = _TRANSFORMS.get(etree.QName(child).localname)
            if make is not None:
                count, build = make
                here = here @ build(self._floats(child, child.text or "", count))
        for child in node.iterchildren(etree.Element):
            tag = etree.QName(child).localname
            if tag == "node":
                yield from self._node(child, here, depth + 1)
            elif tag == "instance_node":
                yield from self._node(self._target(child, "url"), here, depth + 1)
            elif tag == "instance_geometry":
                yield here, self._target(child, "url")
            elif tag == "instance_controller":
                raise self._error(child, "a skin or morph, which is not read; export the mesh as it stands")
            elif tag in ("lookat", "skew"):
                raise self._error(child, "is not read; export the mesh with its transforms applied")

    def _geometry(self, geometry: etree._Element) -> Triangles:
        """Corners and triangles of a `<geometry>`, in its own units."""
        mesh = geometry.find("{*}mesh")
        if mesh is None:
            raise self._error(geometry, "holds no <mesh>, and nothing else is read")
        name = geometry.get("id") or str(id(geometry))
        if name not in self.made:
            vertices = {vertices.get("id"): vertices for vertices in mesh.iterfind("{*}vertices")}
            parts = [self._primitive(child, vertices) for child in mesh.iterchildren(etree.Element)]
            points = [np.zeros((0, 3)), *(points for points, _ in parts)]
            starts = np.cumsum([len(these) for these in points])
            faces = [faces + start for (_, faces), start in zip(parts, starts, strict=False)]
            self.made[name] = (
                np.concatenate(points),
                np.concatenate([np.zeros((0, 3), dtype=np.int64), *faces]),
            )
        return self.made[name]

    def _primitive(self, element: etree._Element, vertices: dict[str | None, etree._Element]) -> Triangles:
        tag = etree.QName(element).localname
        nothing = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
        if tag in NO_SURFACE or tag in ("source", "vertices", "extra"):
            return nothing
        if tag not in _POLYGONS:
            raise self._error(element, "is no primitive that is read")
        inputs = element.findall("{*}input")
        stride = 1 + max((int(given.get("offset") or 0) for given in inputs), default=0)
        corner = next((given for given in inputs if given.get("semantic") == "VERTEX"), None)
        lists = [self._whole(p, stride) for p in element.iterfind("{*}p")]
        if element.find("{*}ph") is not None:
            raise self._error(element, "polygons with holes are not read; export triangles")
        if not lists or corner is None:
            if lists or (element.get("count") or "0") != "0":
                raise self._error(element, "has no corners")
            return nothing
        points = self._positions(vertices.get((corner.get("source") or "").removeprefix("#")), corner)
        offset = int(corner.get("offset") or 0)
        counts = element.find("{*}vcount")
        sizes = None if counts is None else self._whole(counts, 1)
        faces = _POLYGONS[tag]([given[offset::stride] for given in lists], sizes)
        if faces is None:
            raise self._error(element, "vcount and p do not fit each other")
        if len(faces) and not (faces.min() >= 0 and faces.max() < len(points)):
            raise self._error(element, f"names corner {faces.max()}, of {len(points)}")
        return points, faces

    def _positions(self, vertices: etree._Element | None, corner: etree._Element) -> NDArray[np.float64]:
        """Corners of a mesh, shape (n, 3)."""
        given = None if vertices is None else vertices.find("{*}input[@semantic='POSITION']")
        if given is None:
            raise self._error(corner, "leads to no positions")
        source = self._target(given, "source")
        accessor = source.find("{*}technique_common/{*}accessor")
        if accessor is None:
            raise self._error(source, "has no <accessor>")
        array = self._target(accessor, "source")
        numbers = self._floats(array, array.text or "", None)
        count, first, stride = (
            int(accessor.get(name) or other) for name, other in (("count", 0), ("offset", 0), ("stride", 1))
        )
        names = [(param.get("name") or "").upper() for param in accessor.iterfind("{*}param")]
        columns = [names.index(axis) for axis in "XYZ"] if set("XYZ") <= set(names) else [0, 1, 2]
        if first + count * stride > len(numbers) or stride < 3:
            raise self._error(accessor, f"asks for {count} corners, its array holds {len(numbers)} numbers")
        return numbers[first : first + count * stride].reshape(count, stride)[:, columns]

    def _floats(self, element: etree._Element, text: str, count: int | None) -> NDArray[np.float64]:
        try:
            numbers = np.array(text.split(), dtype=np.float64)
        except ValueError as error:
            raise self._error(element, str(error)) from None
        if count is not None and len(numbers) != count:
            raise self._error(element, f"holds {len(numbers)} numbers, expected {count}")
        return numbers

    def _whole(self, element: etree._Element, multiple: int) -> NDArray[np.int64]:
        try:
            numbers = np.array((element.text or "").split(), dtype=np.int64)
        except (ValueError, OverflowError) as error:
            raise self._error(element, str(error)) from None
        if len(numbers) % multiple:
            raise self._error(element, f"holds {len(numbers)} numbers, which is no multiple of {multiple}")
        return numbers


def _rotation(given: NDArray[np.float64]) -> NDArray[np.float64]:
    if not np.linalg.norm(given[:3]) > 0:
        return np.eye(4)
    turn: NDArray[np.float64] = transformations.rotation_matrix(np.radians(given[3]), given[:3])
    return turn


_TRANSFORMS: dict[str, tuple[int, Callable[[NDArray[np.float64]], NDArray[np.float64]]]] = {
    "matrix": (16, lambda given: given.reshape(4, 4)),
    "translate": (3, lambda given: np.asarray(transformations.translation_matrix(given))),
    "rotate": (4, _rotation),
    "scale": (3, lambda given: np.diag([*given, 1.0])),
}
"""How many numbers each element of a node holds, and the matrix that it means."""

Lists = list[NDArray[np.int64]]
Sizes = NDArray[np.int64] | None


def _fan(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles of a polygon about its first corner: together they cover it, also where it is not convex."""
    return np.column_stack([np.full(len(corners) - 2, corners[0]), corners[1:-1], corners[2:]])


def _joined(parts: Lists) -> NDArray[np.int64]:
    return np.concatenate([np.zeros((0, 3), dtype=np.int64), *parts])


def _triangles(lists: Lists, sizes: Sizes) -> NDArray[np.int64] | None:
    corners = np.concatenate(lists)
    return corners.reshape(-1, 3) if len(corners) % 3 == 0 else None


def _polylist(lists: Lists, sizes: Sizes) -> NDArray[np.int64] | None:
    corners = np.concatenate(lists)
    if sizes is None or sizes.sum() != len(corners):
        return None
    ends = np.cumsum(sizes)
    if len(sizes) and (sizes == 3).all():
        return corners.reshape(-1, 3)
    return _joined(
        [_fan(corners[end - size : end]) for end, size in zip(ends, sizes, strict=True) if size > 2]
    )


def _fans(lists: Lists, sizes: Sizes) -> NDArray[np.int64]:
    return _joined([_fan(corners) for corners in lists if len(corners) > 2])


def _strips(lists: Lists, sizes: Sizes) -> NDArray[np.int64]:
    strips = []
    for corners in lists:
        faces = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
        faces[1::2] = faces[1::2, ::-1]
        strips.append(faces)
    return _joined(strips)


_POLYGONS: dict[str, Callable[[Lists, Sizes], NDArray[np.int64] | None]] = {
    "triangles": _triangles,
    "polylist": _polylist,
    "polygons": _fans,
    "trifans": _fans,
    "tristrips": _strips,
}
"""Triangles of each kind of primitive."""
