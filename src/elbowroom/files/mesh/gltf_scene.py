"""A glTF file's scene: every node with a mesh is an object where transforms, instances, bones and morphs put it."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.gltf_file import GltfFile, gltf_file
from elbowroom.files.mesh.gltf_shapes import Shape, shape_of
from elbowroom.files.mesh.gltf_values import values
from elbowroom.files.mesh.objects import MeshFile, MeshObject, named_apart

Array = NDArray[np.float64]


def read_gltf(path: Path) -> MeshFile:
    """The objects of the scene that the file shows, in metres, y up, as glTF has it.

    Raises:
        InputError: a file, a node or a mesh that cannot be read; it is named.
    """
    file = gltf_file(path)
    try:
        scene = _Scene(file)
        shown = list(scene.shown())
        names = named_apart([name for name, _, _ in shown])
        objects = [
            MeshObject(own, vertices, _turned(shape.faces, mirrored), shape.colour)
            for own, (_, shape, (vertices, mirrored)) in zip(names, shown, strict=True)
            if len(shape.faces)
        ]
    except (KeyError, TypeError, IndexError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: damaged glTF ({type(error).__name__}: {error}); export it again"
        ) from error
    objects.sort(key=lambda one: one.name)
    return MeshFile(tuple(objects), "y", 1.0, tuple(scene.notes))


def _turned(faces: NDArray[np.int64], mirrored: bool) -> NDArray[np.int64]:
    return faces[:, ::-1] if mirrored else faces


@dataclass(frozen=True)
class _Scene:
    """Walks the nodes that are shown."""

    file: GltfFile

    @cached_property
    def notes(self) -> list[str]:
        """What is not shown, and why."""
        return []

    @cached_property
    def nodes(self) -> list[dict[str, Any]]:
        return list(self.file.listed("nodes"))

    @cached_property
    def parents(self) -> dict[int, int]:
        return {child: n for n, node in enumerate(self.nodes) for child in node.get("children") or ()}

    def name(self, number: int) -> str:
        node = self.nodes[number]
        meshes = self.file.listed("meshes")
        mesh = meshes[node["mesh"]].get("name") if "mesh" in node else None
        return str(node.get("name") or mesh or f"node {number}")

    def roots(self) -> list[int]:
        """Of the scene that the file says is shown."""
        scenes = self.file.listed("scenes")
        if not scenes:
            return [n for n in range(len(self.nodes)) if n not in self.parents]
        chosen = self.file.content.get("scene")
        if chosen is None and len([s for s in scenes if s.get("nodes")]) > 1:
            names = ", ".join(str(s.get("name", n)) for n, s in enumerate(scenes))
            raise InputError(
                f"{self.file.path}: holds {len(scenes)} scenes ({names}) and does not say which is meant; export one"
            )
        if chosen is None:
            chosen = next((n for n, s in enumerate(scenes) if s.get("nodes")), 0)
        return list(scenes[chosen].get("nodes") or ())

    def shown(self) -> Iterator[tuple[str, Shape, tuple[Array, bool]]]:
        """Name, shape, vertices where they are, and whether their faces are to be turned."""
        waiting = [(number, True) for number in reversed(self.roots())]
        reached: set[int] = set()
        hidden = []
        while waiting:
            number, visible = waiting.pop()
            if number in reached:
                raise InputError(
                    f"{self.file.path}: node {self.name(number)!r} hangs in two places; export it again"
                )
            reached.add(number)
            node = self.nodes[number]
            sight = (node.get("extensions") or {}).get("KHR_node_visibility") or {}
            visible = visible and bool(sight.get("visible", True))
            waiting += [(child, visible) for child in reversed(node.get("children") or ())]
            if "mesh" not in node:
                continue
            if visible:
                yield from self._placed(number)
            else:
                hidden.append(self.name(number))
        self._note(reached, hidden)

    def _note(self, reached: set[int], hidden: list[str]) -> None:
        if hidden:
            self.notes.append(f"left out as the file hides them: {_listed(hidden)}")
        beside = [self.name(n) for n, node in enumerate(self.nodes) if "mesh" in node and n not in reached]
        if beside:
            self.notes.append(f"left out as they are not in the scene that the file shows: {_listed(beside)}")

    def _placed(self, number: int) -> Iterator[tuple[str, Shape, tuple[Array, bool]]]:
        node, name = self.nodes[number], self.name(number)
        shape = shape_of(self.file, node["mesh"], node.get("weights"), with_bones="skin" in node)
        if not len(shape.faces):
            self.notes.append(f"{name!r} holds no faces, only points or lines: no surface")
            return
        if "skin" in node:
            yield name, shape, self._on_bones(shape, node["skin"], name)
            return
        world = self.world(number)
        for own in self._instances(node, name):
            placed = world if own is None else world @ own
            yield name, shape, _moved(shape.vertices, placed)

    def world(self, number: int) -> Array:
        """Where a node's frame lies in the scene, shape (4, 4)."""
        placed, seen = _local(self.nodes[number], self.file, self.name(number)), {number}
        while number in self.parents:
            number = self.parents[number]
            if number in seen:
                raise InputError(
                    f"{self.file.path}: node {self.name(number)!r} hangs on itself; export it again"
                )
            seen.add(number)
            placed = _local(self.nodes[number], self.file, self.name(number)) @ placed
        return placed

    def _instances(self, node: dict[str, Any], name: str) -> list[Array | None]:
        """Places of a node's mesh in the node's frame (EXT_mesh_gpu_instancing); one None: the frame itself."""
        given = (node.get("extensions") or {}).get("EXT_mesh_gpu_instancing")
        if given is None:
            return [None]
        read = {
            key: values(self.file, number, f"node {name!r}")
            for key, number in given["attributes"].items()
            if key in ("TRANSLATION", "ROTATION", "SCALE")
        }
        count = max((len(rows) for rows in read.values()), default=1)
        if any(len(rows) != count for rows in read.values()):
            raise InputError(f"{self.file.path}: node {name!r}: its instances have lists of unlike length")
        return [
            _local({key.lower(): rows[n].tolist() for key, rows in read.items()}, self.file, name)
            for n in range(count)
        ]

    def _on_bones(self, shape: Shape, number: int, name: str) -> tuple[Array, bool]:
        """Vertices where the skeleton as it stands in the file carries them; the node's own place does not matter."""
        skin = self.file.listed("skins")[number]
        joints = skin["joints"]
        bones = np.array([self.world(joint) for joint in joints])
        if "inverseBindMatrices" in skin:
            rows = values(self.file, skin["inverseBindMatrices"], f"skin of node {name!r}")
            if len(rows) < len(joints):
                raise InputError(
                    f"{self.file.path}: node {name!r}: {len(rows)} matrices for {len(joints)} bones"
                )
            # column by column
            bones = bones @ rows[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
        assert shape.joints is not None and shape.weights is not None
        if shape.joints.min() < 0 or shape.joints.max() >= len(joints):
            raise InputError(
                f"{self.file.path}: node {name!r}: hangs on bone {shape.joints.max()} of {len(joints)}; export it with "
                "modifiers applied"
            )
        blended = np.einsum("nk,nkij->nij", shape.weights, bones[shape.joints])
        placed = np.einsum("nij,nj->ni", blended[:, :3, :3], shape.vertices) + blended[:, :3, 3]
        return placed, bool(np.median(np.linalg.det(blended[:, :3, :3])) < 0)


def _moved(vertices: Array, placed: Array) -> tuple[Array, bool]:
    return vertices @ placed[:3, :3].T + placed[:3, 3], bool(np.linalg.det(placed[:3, :3]) < 0)


def _local(node: dict[str, Any], file: GltfFile, name: str) -> Array:
    """A node's frame in its parent's, shape (4, 4)."""
    if "matrix" in node:
        placed = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    else:
        placed = np.eye(4)
        placed[:3, :3] = _turn(node.get("rotation", (0, 0, 0, 1)), file, name) * np.array(
            node.get("scale", (1, 1, 1)), dtype=np.float64
        )
        placed[:3, 3] = node.get("translation", (0, 0, 0))
    if not np.isfinite(placed).all():
        raise InputError(f"{file.path}: node {name!r}: its place is not of finite numbers; repair it")
    return placed


def _turn(quaternion: Any, file: GltfFile, name: str) -> Array:
    """Rotation matrix of a quaternion x, y, z, w, shape (3, 3)."""
    x, y, z, w = (float(value) for value in quaternion)
    length = float(np.sqrt(x * x + y * y + z * z + w * w))
    if not length > 0:
        raise InputError(f"{file.path}: node {name!r}: its rotation is no quaternion; repair it")
    x, y, z, w = x / length, y / length, z / length, w / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _listed(names: list[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
