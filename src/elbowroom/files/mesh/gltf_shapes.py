"""Shapes of a glTF file: the triangles of a mesh, with its morph targets and, if it has some, its bones' weights."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.gltf_file import COMPRESSED, GltfFile
from elbowroom.files.mesh.gltf_values import values
from elbowroom.files.mesh.objects import Colour
from elbowroom.files.mesh.polygons import fan, strip

Array = NDArray[np.float64]
TRIANGLES, STRIP, FAN = 4, 5, 6


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A mesh in its own frame.

    Args:
        vertices: morph targets added by their weights, shape (n, 3).
        faces: shape (m, 3).
        colour: of its first material.
        joints, weights: of each vertex, shape (n, k); None: the mesh says none.
    """

    vertices: Array
    faces: NDArray[np.int64]
    colour: Colour | None
    joints: NDArray[np.int64] | None
    weights: Array | None


def shape_of(
    file: GltfFile, number: int, morph_weights: Sequence[float] | None, *, with_bones: bool
) -> Shape:
    """The triangles of a mesh; points and lines of it are no surface.

    Args:
        file: whose it is.
        number: of the mesh.
        morph_weights: of its morph targets; None: as the mesh says.
        with_bones: whether joints and weights are asked for.

    Raises:
        InputError: a part of it cannot be read; names the mesh.
    """
    mesh = file.listed("meshes")[number]
    what = f"mesh {mesh.get('name', number)!r}"
    morph = list(morph_weights if morph_weights is not None else mesh.get("weights") or ())
    parts = [
        _part(file, part, morph, what, with_bones)
        for part in mesh["primitives"]
        if part.get("mode", TRIANGLES) in (TRIANGLES, STRIP, FAN)
    ]
    if not parts:
        return Shape(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), None, None, None)
    before = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Shape(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + n for part, n in zip(parts, before[:-1], strict=True)]),
        next((part.colour for part in parts if part.colour is not None), None),
        _side_by_side([part.joints for part in parts]),
        _side_by_side([part.weights for part in parts]),
    )


def _side_by_side(parts: Sequence[NDArray[Any] | None]) -> NDArray[Any] | None:
    given = [part for part in parts if part is not None]
    if not given:
        return None
    width = max(part.shape[1] for part in given)
    return np.concatenate([np.pad(part, ((0, 0), (0, width - part.shape[1]))) for part in given])


def _part(file: GltfFile, part: dict[str, Any], morph: Sequence[float], what: str, with_bones: bool) -> Shape:
    attributes = part["attributes"]
    if "POSITION" not in attributes:
        raise InputError(f"{file.path}: {what}: a part of it has no POSITION; export it again")
    _require_unpacked(file, part, what)
    vertices = values(file, attributes["POSITION"], what).astype(np.float64)
    if vertices.shape[1] != 3:
        raise InputError(
            f"{file.path}: {what}: POSITION has {vertices.shape[1]} numbers a vertex, expected 3"
        )
    for weight, target in zip(morph, part.get("targets") or (), strict=False):
        if weight and "POSITION" in target:
            vertices = vertices + weight * values(file, target["POSITION"], what)
    faces = _faces(file, part, len(vertices), what)
    joints = weights = None
    if with_bones:
        joints, weights = _bones(file, attributes, what)
    return Shape(vertices, faces, _colour(file, part), joints, weights)


def _require_unpacked(file: GltfFile, part: dict[str, Any], what: str) -> None:
    packed = [name for name in COMPRESSED if name in (part.get("extensions") or {})]
    used = [part["attributes"]["POSITION"], *([part["indices"]] if "indices" in part else [])]
    accessors = file.listed("accessors")
    if packed and any("bufferView" not in accessors[number] for number in used):
        raise InputError(
            f"{file.path}: {what}: its shape is packed ({', '.join(packed)}) and not there unpacked; export it "
            "without compression"
        )


def _faces(file: GltfFile, part: dict[str, Any], count: int, what: str) -> NDArray[np.int64]:
    if "indices" in part:
        index = values(file, part["indices"], what)[:, 0].astype(np.int64)
    else:
        index = np.arange(count, dtype=np.int64)
    if len(index) and (index.min() < 0 or index.max() >= count):
        raise InputError(
            f"{file.path}: {what}: a face names vertex {index.max()} of {count}; export it again"
        )
    mode = part.get("mode", TRIANGLES)
    if mode == TRIANGLES and len(index) % 3:
        raise InputError(
            f"{file.path}: {what}: {len(index)} corners make no whole triangles; export it again"
        )
    if len(index) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    if mode == STRIP:
        return strip(index)
    return fan(index[None]) if mode == FAN else index.reshape(-1, 3)


def _bones(file: GltfFile, attributes: dict[str, int], what: str) -> tuple[NDArray[np.int64], Array]:
    sets = range(sum(name.startswith("JOINTS_") for name in attributes))
    if not sets or any(f"{kind}_{n}" not in attributes for n in sets for kind in ("JOINTS", "WEIGHTS")):
        raise InputError(
            f"{file.path}: {what}: hangs on bones, but not all of its vertices say on which; export it with "
            "modifiers applied"
        )
    joints = np.concatenate([values(file, attributes[f"JOINTS_{n}"], what) for n in sets], axis=1)
    weights = np.concatenate([values(file, attributes[f"WEIGHTS_{n}"], what) for n in sets], axis=1)
    total = weights.sum(axis=1, keepdims=True, dtype=np.float64)
    if not (np.isfinite(total).all() and (total > 0).all()):
        raise InputError(f"{file.path}: {what}: a vertex hangs on no bone; export it with modifiers applied")
    return joints.astype(np.int64), weights / total


def _colour(file: GltfFile, part: dict[str, Any]) -> Colour | None:
    """Of the part's material, in steps of a 255th."""
    if "material" not in part:
        return None
    material = file.listed("materials")[part["material"]]
    metal = material.get("pbrMetallicRoughness") or {}
    gloss = (material.get("extensions") or {}).get("KHR_materials_pbrSpecularGlossiness") or {}
    factor = metal.get("baseColorFactor") or gloss.get("diffuseFactor")
    if factor is None:
        return None
    red, green, blue = (round(255 * float(value)) / 255 for value in factor[:3])
    return red, green, blue
