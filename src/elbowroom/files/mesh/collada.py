"""Collada (.dae): the objects of its scene, and the unit and the axis that it declares."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, cast
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.collada_shapes import Shape, shape_of
from elbowroom.files.mesh.objects import Axis, MeshFile, MeshObject, named_apart

Array = NDArray[np.float64]
Element = ElementTree.Element
DEEPEST = 100
"""Nodes in nodes; one that holds itself goes deeper."""


def read_collada(path: Path) -> MeshFile:
    """The objects of the scene that the file shows, in its own unit and axes, which are told beside.

    Raises:
        InputError: a file, a node or a geometry that cannot be read; it is named.
    """
    try:
        root = ElementTree.fromstring(path.read_bytes())
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]
        if root.tag != "COLLADA":
            raise ValueError(f"its first element is {root.tag}")
        unit_m, up = _asset(root)
        walk = _Walk(path, {one.get("id", ""): one for one in root.iter() if one.get("id")})
        shown = list(walk.scene(root))
    except (ElementTree.ParseError, ValueError, TypeError, IndexError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: damaged Collada ({type(error).__name__}: {error}); export it again"
        ) from error
    names = named_apart([name for name, _, _ in shown])
    objects = [
        MeshObject(own, vertices, faces) for own, (_, vertices, faces) in zip(names, shown, strict=True)
    ]
    return MeshFile(tuple(sorted(objects, key=lambda one: one.name)), up, unit_m, tuple(walk.notes))


def _asset(root: Element) -> tuple[float, Axis]:
    """Metres of a unit and the axis that is up; the standard's where the file says nothing: 1 m and y."""
    unit, axis = root.find("asset/unit"), root.findtext("asset/up_axis")
    metres = 1.0 if unit is None else float(unit.get("meter", "1"))
    if not (np.isfinite(metres) and metres > 0):
        raise ValueError(f"a unit of {metres} m")
    word = "Y_UP" if axis is None else axis.strip()
    if word not in ("X_UP", "Y_UP", "Z_UP"):
        raise ValueError(f"up_axis {word!r}")
    return metres, cast(Literal["x", "y", "z"], word[0].lower())


@dataclass
class _Walk:
    """Follows the nodes of the scene.

    Args:
        path: of the file.
        by_id: its elements.
    """

    path: Path
    by_id: dict[str, Element]
    notes: list[str] = field(default_factory=list)
    shapes: dict[str, Shape] = field(default_factory=dict)

    def scene(self, root: Element) -> Iterator[tuple[str, Array, NDArray[np.int64]]]:
        """Name, vertices and faces of every object that the scene shows."""
        given = root.find("scene/instance_visual_scene")
        scenes = root.findall("library_visual_scenes/visual_scene")
        if given is not None:
            shown = self.found(given, "the scene")
        elif len(scenes) == 1:
            shown = scenes[0]
        else:
            raise InputError(f"{self.path}: holds {len(scenes)} scenes and shows none; export one scene")
        for node in shown.findall("node"):
            yield from self.node(node, np.eye(4), 0)

    def found(self, reference: Element, what: str) -> Element:
        """What an element's url points at."""
        url = reference.get("url", "")
        if not url.startswith("#"):
            raise InputError(f"{self.path}: {what}: lies in another file, {url!r}; export all into one file")
        if url[1:] not in self.by_id:
            raise InputError(f"{self.path}: {what}: {url} is not in the file; export it again")
        return self.by_id[url[1:]]

    def node(
        self, node: Element, parent: Array, depth: int
    ) -> Iterator[tuple[str, Array, NDArray[np.int64]]]:
        """The objects of a node and of those in it."""
        name = node.get("name") or node.get("id") or "node"
        if depth > DEEPEST:
            raise InputError(f"{self.path}: node {name!r} holds itself; export it again")
        world = parent
        for child in node:
            world = world @ self.transform(child, name)
        for child in node:
            if child.tag == "instance_geometry":
                yield from self.geometry(child, name, world)
            elif child.tag == "instance_controller":
                raise InputError(
                    f"{self.path}: node {name!r} is posed by bones or morphs ({child.get('url')}); export it with "
                    "modifiers applied"
                )
            elif child.tag == "instance_node":
                yield from self.node(self.found(child, f"node {name!r}"), world, depth + 1)
            elif child.tag == "node":
                yield from self.node(child, world, depth + 1)

    def geometry(
        self, instance: Element, name: str, world: Array
    ) -> Iterator[tuple[str, Array, NDArray[np.int64]]]:
        """One geometry in its place."""
        given = self.found(instance, f"node {name!r}")
        key = given.get("id", "")
        if key not in self.shapes:
            self.shapes[key] = shape_of(self.path, given)
        vertices, faces = self.shapes[key]
        if not len(faces):
            self.notes.append(f"{name!r} holds no faces, only points or lines: no surface")
            return
        placed = vertices @ world[:3, :3].T + world[:3, 3]
        yield name, placed, faces[:, ::-1] if np.linalg.det(world[:3, :3]) < 0 else faces

    def transform(self, element: Element, name: str) -> Array:
        """What one element of a node adds to its place, shape (4, 4)."""
        made = np.eye(4)
        if element.tag in ("skew", "lookat"):
            raise InputError(
                f"{self.path}: node {name!r}: is placed by <{element.tag}>; export it with a matrix"
            )
        if element.tag not in ("matrix", "translate", "scale", "rotate"):
            return made
        numbers = np.array((element.text or "").split(), dtype=np.float64)
        if element.tag == "matrix":
            made = numbers.reshape(4, 4)
        elif element.tag == "translate":
            made[:3, 3] = numbers
        elif element.tag == "scale":
            made[:3, :3] = np.diag(numbers)
        else:
            made[:3, :3] = _about(numbers[:3], float(np.radians(numbers[3])))
        if not np.isfinite(made).all():
            raise InputError(
                f"{self.path}: node {name!r}: <{element.tag}> is not of finite numbers; repair it"
            )
        return made


def _about(axis: Array, angle: float) -> Array:
    """Rotation about an axis by an angle [rad] (Rodrigues), shape (3, 3)."""
    length = np.linalg.norm(axis)
    if not length > 0:
        return np.eye(3)
    x, y, z = axis / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
