"""Triangles of one piece of URDF geometry: a mesh file, a box, a cylinder or a sphere."""

import math
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

import numpy as np
import trimesh
from numpy.typing import NDArray
from yourdfpy import urdf as yourdf

from elbowroom.errors import MachineError

MESH_SUFFIXES = (".stl", ".obj", ".glb", ".ply")
"""Mesh files that can be read."""
CHORD_ERROR_M = 0.0005
"""How far the flat sides of a cylinder or sphere may stand out of the solid [m]; they never lie inside."""
SEARCH_LEVELS = 8
"""How many folders above the URDF are searched for the files of a package."""

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]


def mesh_path(filename: str, urdf_path: Path, package_dirs: Sequence[Path]) -> Path | None:
    """Where the mesh file of a URDF lies, or None if nowhere.

    `package://name/rest` is looked for in `package_dirs`, then in the folders above the URDF; each is tried
    with the whole of `name/rest`, then without its first part, and so on, as long as a folder and a file name
    are left. So a robot that was copied out of its package is found as well.

    Args:
        filename: as the URDF gives it: `package://`, `file://`, or a path relative to the URDF.
        urdf_path: the URDF file.
        package_dirs: folders that hold packages, or are packages.
    """
    if "://" not in filename:
        path = urdf_path.parent / filename
        return path if path.is_file() else None
    scheme, rest = filename.split("://", 1)
    if scheme == "file":
        return Path(rest) if Path(rest).is_file() else None
    if scheme != "package":
        return None
    parts = PurePosixPath(rest).parts
    if ".." in parts:
        return None
    folders = [*package_dirs, *list(urdf_path.resolve().parents)[:SEARCH_LEVELS]]
    for first in range(max(1, len(parts) - 1)):
        for folder in folders:
            path = folder.joinpath(*parts[first:])
            if path.is_file():
                return path
    return None


def triangles_of(geometry: yourdf.Geometry, path: Path | None, what: str) -> Triangles:
    """Vertices, shape (n, 3) [m], and faces, shape (m, 3), of one geometry in its own frame.

    Args:
        geometry: as yourdfpy parsed it.
        path: the mesh file, for a mesh.
        what: how errors name it.

    Raises:
        MachineError: a mesh file that holds no triangles or is of an unknown kind, a primitive without size.
    """
    if geometry.mesh is not None:
        assert path is not None
        vertices, faces = file_triangles(path, what)
        scale = 1.0 if geometry.mesh.scale is None else geometry.mesh.scale
        return vertices * scale, faces
    if geometry.box is not None:
        return box_triangles(what, geometry.box.size)
    if geometry.cylinder is not None:
        return cylinder_triangles(what, geometry.cylinder.radius, geometry.cylinder.length)
    if geometry.sphere is not None:
        mesh = _sphere(*_sizes(what, geometry.sphere.radius))
    else:
        raise MachineError(f"{what}: no geometry; allowed are mesh, box, cylinder, sphere")
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def file_triangles(path: Path, what: str) -> Triangles:
    """Those of a mesh file, in its own unit.

    Args:
        path: the file, which exists.
        what: how errors name it.

    Raises:
        MachineError: no triangles, or a file of an unknown kind.
    """
    mesh = _read(path, what)
    return np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces)


def box_triangles(what: str, size_m: Sequence[float]) -> Triangles:
    """Those of a box about the origin.

    Args:
        what: how errors name it.
        size_m: its edges [m].

    Raises:
        MachineError: an edge that is not above 0.
    """
    mesh = trimesh.creation.box(extents=_sizes(what, *size_m))
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def cylinder_triangles(what: str, radius_m: float, length_m: float) -> Triangles:
    """Those of a prism that contains a cylinder about the z axis, its middle in the origin.

    Args:
        what: how errors name it.
        radius_m, length_m: of the cylinder [m].

    Raises:
        MachineError: a size that is not above 0.
    """
    mesh = _cylinder(*_sizes(what, radius_m, length_m))
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def _read(path: Path, what: str) -> trimesh.Trimesh:
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise MachineError(f"{what}: {path} is of an unknown kind; allowed are {', '.join(MESH_SUFFIXES)}")
    try:
        mesh = trimesh.load(path, force="mesh")
    except Exception as error:  # trimesh's readers raise whatever their formats' parsers raise
        raise MachineError(f"{what}: mesh {path} cannot be read: {error}") from error
    if not (isinstance(mesh, trimesh.Trimesh) and len(mesh.faces) and np.isfinite(mesh.vertices).all()):
        raise MachineError(f"{what}: mesh {path} holds no triangles with finite corners")
    return mesh


def _sizes(what: str, *sizes: float) -> tuple[float, ...]:
    if not all(math.isfinite(size) and size > 0 for size in sizes):
        raise MachineError(f"{what}: sizes {tuple(map(float, sizes))} must be finite and above 0 [m]")
    return sizes


def _cylinder(radius: float, length: float) -> trimesh.Trimesh:
    """A prism that contains the cylinder and stands out of it by `CHORD_ERROR_M` at most."""
    half_angle = math.acos(radius / (radius + CHORD_ERROR_M))
    sides = max(12, math.ceil(math.pi / half_angle))
    return trimesh.creation.cylinder(radius / math.cos(math.pi / sides), height=length, sections=sides)


def _sphere(radius: float) -> trimesh.Trimesh:
    """A polyhedron that contains the sphere; stands out of it by `CHORD_ERROR_M`, or 0.2 % if large."""
    for subdivisions in (2, 3, 4):
        mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
        inner = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles[:, 0]).min()
        if radius / inner - radius <= CHORD_ERROR_M:
            break
    mesh.apply_scale(radius / inner)
    return mesh
