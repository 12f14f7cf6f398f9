"""Triangles of one piece of a link's geometry: a mesh file, a box, a cylinder, a sphere or a capsule."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from elbowroom.geometry import solids
from elbowroom.geometry.solids import Triangles
from elbowroom.machine.description.shapes import Kind, Shape

if TYPE_CHECKING:
    import trimesh

    from elbowroom.machine.mesh_file import MeshFile

CHORD_ERROR_M = 0.0005
"""How far the flat sides of a round solid may stand out of it [m]; they never lie inside."""


def triangles_of(shape: Shape, mesh_file: "MeshFile | None") -> Triangles:
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
    return _SOLIDS[kind](*sizes)


def _box(*size: float) -> Triangles:
    return solids.box(size)


def _outer_radius(radius: float) -> tuple[float, int]:
    """Of a polygon that contains a circle and stands out of it by `CHORD_ERROR_M` at most: radius and sides."""
    half_angle = math.acos(radius / (radius + CHORD_ERROR_M))
    sides = max(12, math.ceil(math.pi / half_angle))
    return radius / math.cos(math.pi / sides), sides


def _cylinder(radius: float, length: float) -> Triangles:
    """A prism that contains the cylinder and stands out of it by `CHORD_ERROR_M` at most."""
    outer, sides = _outer_radius(radius)
    return solids.prism(outer, length, sides)


def _sphere(radius: float) -> Triangles:
    return _taken(_ball(radius))


def _ball(radius: float) -> "trimesh.Trimesh":
    """A polyhedron that contains the sphere; stands out of it by `CHORD_ERROR_M`, or 0.2 % if large."""
    import trimesh  # slow to load, and many machines have nothing round but cylinders

    for subdivisions in (2, 3, 4):
        mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
        inner = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles[:, 0]).min()
        if radius / inner - radius <= CHORD_ERROR_M:
            break
    mesh.apply_scale(radius / inner)
    return mesh


def _capsule(radius: float, length: float) -> Triangles:
    """The hull of two spheres' polyhedra, `length` apart along z: it contains the capsule."""
    import trimesh

    ball = _ball(radius)
    if length == 0:
        return _taken(ball)
    half = np.array([0.0, 0.0, length / 2])
    return _taken(trimesh.convex.convex_hull(np.vstack([ball.vertices + half, ball.vertices - half])))


def _ellipsoid(a: float, b: float, c: float) -> Triangles:
    """A sphere's polyhedron, stretched: it contains the ellipsoid."""
    mesh = _ball(1.0)
    mesh.vertices = mesh.vertices * (a, b, c)
    return _taken(mesh)


def _taken(mesh: "trimesh.Trimesh") -> Triangles:
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


_SOLIDS: dict[str, Callable[..., Triangles]] = {
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "capsule": _capsule,
    "ellipsoid": _ellipsoid,
}
