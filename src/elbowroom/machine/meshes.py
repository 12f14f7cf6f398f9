"""Triangles of one piece of a link's geometry: a mesh file, a box, a cylinder, a sphere or a capsule."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray

from elbowroom.machine.description.shapes import Kind, Shape
from elbowroom.machine.mesh_file import MeshFile

CHORD_ERROR_M = 0.0005
"""How far the flat sides of a round solid may stand out of it [m]; they never lie inside."""

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]


def triangles_of(shape: Shape, mesh_file: MeshFile | None) -> Triangles:
    """Vertices, shape (n, 3) [m], and faces, shape (m, 3), of one geometry in its own frame.

    Args:
        shape: as the description gives it.
        mesh_file: what its file holds, for a mesh.
    """
    if mesh_file is not None:
        faces = mesh_file.faces[:, ::-1] if np.prod(np.sign(shape.scale)) < 0 else mesh_file.faces
        scale = shape.scale[0] if len(set(shape.scale)) == 1 else np.array(shape.scale)
        return mesh_file.vertices * scale, faces
    return solid_triangles(shape.kind, shape.sizes)


def solid_triangles(kind: Kind, sizes: Sequence[float]) -> Triangles:
    """Vertices, shape (n, 3) [m], and faces, shape (m, 3), of a solid about the origin.

    Args:
        kind: any but a mesh.
        sizes: as of `Shape` [m], above 0.
    """
    mesh = _SOLIDS[kind](*sizes)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def _box(*size: float) -> trimesh.Trimesh:
    return trimesh.creation.box(extents=size)


def _outer_radius(radius: float) -> tuple[float, int]:
    """Of a polygon that contains a circle and stands out of it by `CHORD_ERROR_M` at most: radius and sides."""
    half_angle = math.acos(radius / (radius + CHORD_ERROR_M))
    sides = max(12, math.ceil(math.pi / half_angle))
    return radius / math.cos(math.pi / sides), sides


def _cylinder(radius: float, length: float) -> trimesh.Trimesh:
    """A prism that contains the cylinder and stands out of it by `CHORD_ERROR_M` at most."""
    outer, sides = _outer_radius(radius)
    return trimesh.creation.cylinder(outer, height=length, sections=sides)


def _sphere(radius: float) -> trimesh.Trimesh:
    """A polyhedron that contains the sphere; stands out of it by `CHORD_ERROR_M`, or 0.2 % if large."""
    for subdivisions in (2, 3, 4):
        mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
        inner = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles[:, 0]).min()
        if radius / inner - radius <= CHORD_ERROR_M:
            break
    mesh.apply_scale(radius / inner)
    return mesh


def _capsule(radius: float, length: float) -> trimesh.Trimesh:
    """The hull of two spheres' polyhedra, `length` apart along z: it contains the capsule."""
    ball = _sphere(radius)
    if length == 0:
        return ball
    half = np.array([0.0, 0.0, length / 2])
    return trimesh.convex.convex_hull(np.vstack([ball.vertices + half, ball.vertices - half]))


def _ellipsoid(a: float, b: float, c: float) -> trimesh.Trimesh:
    """A sphere's polyhedron, stretched: it contains the ellipsoid."""
    mesh = _sphere(1.0)
    mesh.vertices = mesh.vertices * (a, b, c)
    return mesh


_SOLIDS: dict[str, Callable[..., trimesh.Trimesh]] = {
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "capsule": _capsule,
    "ellipsoid": _ellipsoid,
}
