"""A room modelled by somebody, from a GLB file: every object a closed solid, or an error that names it."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.simulate.solid import Mesh, Solid

LARGEST_M = 100.0
"""An object that is longer was not modelled in metres [m]."""
SMALLEST_M = 0.2
"""A whole room that is smaller was not modelled in metres [m]."""
DARK_LUMINANCE = 0.05
"""A surface that is darker reflects little of a sensor's light."""
Z_UP_FROM_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
"""glTF has y up and z towards the viewer; here z is up."""


def solids_of_glb(path: str | Path) -> tuple[Solid, ...]:
    """Reads the objects of a GLB file as solids that never move.

    glTF has metres and y up; solids have metres and z up, as Blender shows them. Each object is one solid under its
    own name, with the colour of its first material; one darker than `DARK_LUMINANCE` is dark to sensors, too.

    Args:
        path: of the file.

    Raises:
        InputError: missing, no GLB, empty, an object that is not closed or not in metres; one line that names the
            object and says what to do.
    """
    path = Path(path)
    scene = _scene(path)
    nodes = sorted(scene.graph.nodes_geometry)
    solids = []
    for node in nodes:
        transform, geometry = scene.graph[node]
        shape = scene.geometry[geometry]
        if not hasattr(shape, "faces") or len(shape.faces) == 0:
            continue
        vertices = np.asarray(shape.vertices, dtype=np.float64) @ transform[:3, :3].T + transform[:3, 3]
        mesh = merged_mesh(vertices @ Z_UP_FROM_Y_UP.T, np.asarray(shape.faces))
        _check(path, node, mesh)
        colour = _colour(shape)
        dark = float(np.dot(colour, (0.2126, 0.7152, 0.0722))) < DARK_LUMINANCE
        solids.append(Solid(node, mesh, np.eye(4), is_static=True, is_dark=dark, colour=colour))
    if not solids:
        raise InputError(f"{path}: holds no object with faces; model closed solids and export them as GLB")
    corners = np.concatenate([solid.mesh.vertices for solid in solids])
    if np.ptp(corners, axis=0).max() < SMALLEST_M:
        raise InputError(
            f"{path}: all of it is only {np.ptp(corners, axis=0).max():.3g} m long; glTF is in metres, scale it up"
        )
    return tuple(solids)


def _scene(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected a room as GLB")
    with path.open("rb") as file:
        if file.read(4) != b"glTF":
            raise InputError(f"{path}: not a GLB file; export binary glTF 2.0 (.glb)")
    import trimesh

    try:
        return trimesh.load_scene(path, file_type="glb", process=False, merge_primitives=True)
    except Exception as error:  # whatever a damaged file makes the reader stumble over
        raise InputError(f"{path}: damaged GLB ({type(error).__name__}: {error}); export it again") from error


def merged_mesh(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Mesh:
    """Vertices at one place made one; triangles that thereby lose a corner left out.

    Args:
        vertices: shape (n, 3).
        faces: shape (m, 3), indices of vertices.
    """
    places, index = np.unique(vertices, axis=0, return_inverse=True)
    joined = index.reshape(-1)[faces]
    whole = (joined != np.roll(joined, 1, axis=1)).all(axis=1)
    return Mesh(places, joined[whole])


def _check(path: Path, name: str, mesh: Mesh) -> None:
    longest = float(np.ptp(mesh.vertices, axis=0).max())
    if not np.isfinite(longest):
        raise InputError(f"{path}: object {name!r} has corners that are not finite numbers; repair it")
    if longest > LARGEST_M:
        raise InputError(
            f"{path}: object {name!r} is {longest:,.0f} m long; glTF is in metres, so this looks like millimetres: "
            "scale the room by 0.001 and export it again"
        )
    open_edges = open_edge_count(mesh)
    if open_edges:
        raise InputError(
            f"{path}: object {name!r} is not closed, {open_edges} of its edges have a face on one side only; fill "
            "its holes or give it thickness (in Blender: Solidify, or Fill Holes), then export it again"
        )


def open_edge_count(mesh: Mesh) -> int:
    """Edges that are not passed as often in one direction as in the other: 0 for closed, consistently turned faces."""
    a, b = mesh.faces.astype(np.int64), np.roll(mesh.faces, -1, axis=1).astype(np.int64)
    key = (np.minimum(a, b) * len(mesh.vertices) + np.maximum(a, b)).reshape(-1)
    _, index = np.unique(key, return_inverse=True)
    return int(np.count_nonzero(np.bincount(index.reshape(-1), weights=np.sign(b - a).reshape(-1))))


def _colour(shape: Any) -> tuple[float, float, float]:
    """Of the first material, linear, 0 to 1; grey where there is none."""
    material = getattr(shape.visual, "material", None)
    material = material[0] if isinstance(material, list | tuple) else material
    factor = getattr(material, "baseColorFactor", None)
    if factor is None:
        return (0.5, 0.5, 0.5)
    values = np.asarray(factor)
    red, green, blue = (values[:3] / 255.0 if values.dtype.kind in "iu" else values[:3]).astype(float)
    return (float(red), float(green), float(blue))
