"""Closed bodies in Blender: simple parts joined, grown together where they should look grown, and made light.

Lengths in metres, z up. Nothing here is imported by the package; `build.py` beside it says how to run it.
"""

from collections.abc import Sequence

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

Point = Sequence[float]
Colour = tuple[float, float, float]


class Parts:
    """Closed parts that may overlap, collected in one Blender mesh."""

    def __init__(self) -> None:
        self.bm = bmesh.new()

    def box(self, lower: Point, upper: Point, *, bevel: float = 0.0) -> "Parts":
        """An axis-aligned box, its edges rounded off by `bevel` [m]."""
        middle = (Vector(lower) + Vector(upper)) / 2
        size = Vector(upper) - Vector(lower)
        matrix = Matrix.Translation(middle) @ Matrix.Diagonal((*size, 1.0))
        made = bmesh.ops.create_cube(self.bm, size=1.0, matrix=matrix)
        if bevel:
            edges = {edge for vertex in made["verts"] for edge in vertex.link_edges}
            bmesh.ops.bevel(self.bm, geom=list(edges), offset=bevel, segments=2, profile=0.5, affect="EDGES")
        return self

    def ball(self, centre: Point, radii: Point | float, *, u: int = 14, v: int = 9) -> "Parts":
        """An ellipsoid along the axes."""
        size = (radii,) * 3 if isinstance(radii, float | int) else tuple(radii)
        matrix = Matrix.Translation(Vector(centre)) @ Matrix.Diagonal((*size, 1.0))
        bmesh.ops.create_uvsphere(self.bm, u_segments=u, v_segments=v, radius=1.0, matrix=matrix)
        return self

    def bar(
        self, start: Point, end: Point, radius: float, end_radius: float | None = None, *, n: int = 12
    ) -> "Parts":
        """A round bar that may taper, with flat ends."""
        a, b = Vector(start), Vector(end)
        along = b - a
        matrix = Matrix.Translation((a + b) / 2) @ along.to_track_quat("Z", "Y").to_matrix().to_4x4()
        bmesh.ops.create_cone(
            self.bm,
            cap_ends=True,
            cap_tris=True,
            segments=n,
            radius1=radius,
            radius2=radius if end_radius is None else end_radius,
            depth=along.length,
            matrix=matrix,
        )
        return self

    def limb(
        self, start: Point, end: Point, radius: float, end_radius: float | None = None, *, n: int = 12
    ) -> "Parts":
        """A bar with round ends."""
        last = radius if end_radius is None else end_radius
        self.bar(start, end, radius, last, n=n)
        self.ball(start, radius, u=n, v=8)
        return self.ball(end, last, u=n, v=8)

    def shell(self, vertices: np.ndarray, faces: Sequence[Sequence[int]]) -> "Parts":
        """A closed part given by its vertices (n, 3) and faces."""
        made = [self.bm.verts.new(tuple(map(float, vertex))) for vertex in vertices]
        for face in faces:
            self.bm.faces.new([made[index] for index in face])
        return self

    def tube(self, points: Sequence[Point], radius: float, *, n: int = 8, steps: int = 8) -> "Parts":
        """A cable through points, smooth between them (Catmull-Rom), closed at its ends."""
        path = smooth_path(np.asarray(points, dtype=float), steps)
        tangents = np.gradient(path, axis=0)
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        side = np.cross(tangents[0], (0.3, 0.5, 0.81))
        rings = []
        for place, tangent in zip(path, tangents, strict=True):
            side = side - tangent * (side @ tangent)
            side /= np.linalg.norm(side)
            up = np.cross(tangent, side)
            turn = np.linspace(0, 2 * np.pi, n, endpoint=False)[:, None]
            rings.append(place + radius * (np.cos(turn) * side + np.sin(turn) * up))
        return self.shell(*lofted(rings))

    def revolved(self, profile: Sequence[tuple[float, float]], centre: Point, *, n: int = 28) -> "Parts":
        """A body of revolution about the vertical: (radius, height) from below to above, closed by its ends."""
        turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
        ring = np.stack([np.cos(turn), np.sin(turn), np.zeros(n)], axis=1)
        rings = [ring * (max(r, 1e-4), max(r, 1e-4), 1) + np.array(centre) + (0, 0, h) for r, h in profile]
        return self.shell(*lofted(rings))

    def sheet(self, surface: np.ndarray, thickness: float) -> "Parts":
        """A cloth: a grid of points (rows, columns, 3) given some thickness downwards and sideways."""
        rows, columns = surface.shape[:2]
        along, across = np.gradient(surface, axis=0), np.gradient(surface, axis=1)
        normal = np.cross(along, across)
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
        vertices = np.concatenate([surface.reshape(-1, 3), (surface - thickness * normal).reshape(-1, 3)])
        at = np.arange(rows * columns).reshape(rows, columns)
        below = at + rows * columns
        faces = []
        for i in range(rows - 1):
            for j in range(columns - 1):
                faces.append((at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]))
                faces.append((below[i, j], below[i, j + 1], below[i + 1, j + 1], below[i + 1, j]))
        edge = [*((0, j) for j in range(columns)), *((i, columns - 1) for i in range(1, rows))]
        edge += [
            *((rows - 1, j) for j in range(columns - 2, -1, -1)),
            *((i, 0) for i in range(rows - 2, 0, -1)),
        ]
        for (a, b), (c, d) in zip(edge, edge[1:] + edge[:1], strict=True):
            faces.append((at[a, b], at[c, d], below[c, d], below[a, b]))
        return self.shell(vertices, faces)

    def turned(self, world_from_part: Matrix) -> "Parts":
        """Everything so far, moved."""
        bmesh.ops.transform(self.bm, matrix=world_from_part, verts=self.bm.verts)
        return self

    def solid(
        self,
        name: str,
        colour: Colour,
        *,
        grow_m: float | None = None,
        smooth: int = 0,
        folds_m: float = 0.0,
        triangles: int | None = None,
    ) -> bpy.types.Object:
        """The parts as one object of the scene.

        Args:
            name: of the object.
            colour: linear RGB; darker than 5 % counts as a surface that reflects little.
            grow_m: grow the parts together on a lattice of this width [m]; None: leave them as they overlap.
            smooth: rounds of smoothing after that.
            folds_m: depth of random folds, as of cloth [m].
            triangles: at most so many.
        """
        bmesh.ops.recalc_face_normals(self.bm, faces=self.bm.faces)
        mesh = bpy.data.meshes.new(name)
        self.bm.to_mesh(mesh)
        self.bm.free()
        thing = bpy.data.objects.new(name, mesh)
        bpy.context.collection.objects.link(thing)
        if grow_m is not None:
            remesh = thing.modifiers.new("grow", "REMESH")
            remesh.mode, remesh.voxel_size = "VOXEL", grow_m
        if smooth:
            rounded = thing.modifiers.new("smooth", "SMOOTH")
            rounded.factor, rounded.iterations = 0.5, smooth
        if folds_m:
            texture = bpy.data.textures.new(name, "CLOUDS")
            texture.noise_scale = 0.09
            folds = thing.modifiers.new("folds", "DISPLACE")
            folds.texture, folds.strength, folds.mid_level = texture, folds_m, 0.5
        thing.modifiers.new("triangles", "TRIANGULATE")
        if triangles is not None:
            light = thing.modifiers.new("light", "DECIMATE")
            have = len(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh().polygons)
            light.ratio = min(1.0, triangles / have)
        graph = bpy.context.evaluated_depsgraph_get()
        finished = bpy.data.meshes.new_from_object(thing.evaluated_get(graph))
        thing.modifiers.clear()
        thing.data = finished
        merge(thing)
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (*colour, 1.0)
        shader.inputs["Roughness"].default_value = 0.7
        finished.materials.clear()
        finished.materials.append(material)
        return thing


def merge(thing: bpy.types.Object) -> None:
    """Joins vertices at one place, drops faces without area, turns the rest outward."""
    bm = bmesh.new()
    bm.from_mesh(thing.data)
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6)
    bmesh.ops.triangulate(bm, faces=bm.faces)
    bm.to_mesh(thing.data)
    bm.free()


def lofted(rings: Sequence[np.ndarray]) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """Vertices and faces of the closed skin through rings of as many points each."""
    n = len(rings[0])
    faces: list[tuple[int, ...]] = [tuple(range(n))[::-1], tuple(range((len(rings) - 1) * n, len(rings) * n))]
    for r in range(len(rings) - 1):
        for k in range(n):
            a, b = r * n + k, r * n + (k + 1) % n
            faces.append((a, b, b + n, a + n))
    return np.concatenate(rings), faces


def smooth_path(points: np.ndarray, steps: int) -> np.ndarray:
    """Points along a Catmull-Rom spline through the given ones, shape (n, 3)."""
    ends = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    pieces = []
    for a, b, c, d in zip(ends, ends[1:], ends[2:], ends[3:], strict=False):
        pieces.append(
            0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
        )
    return np.concatenate([*pieces, points[-1:]])


def placed(x: float, y: float, heading_deg: float = 0.0, z: float = 0.0) -> Matrix:
    """world_from_part for something that stands at (x, y) and faces `heading_deg` from the x axis."""
    return Matrix.Translation((x, y, z)) @ Matrix.Rotation(np.radians(heading_deg), 4, "Z")
