"""Rays cast at layers: shaded, smooth at the edges, a line where one thing ends before another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.ray_scene import RayScene
from elbowroom.view.picture.layer import Layer
from elbowroom.view.picture.viewpoint import Viewpoint

Array = NDArray[np.float64]
ROWS = 64
"""Of pixels at once, so that a large picture needs little memory."""
SMOOTH = 2
"""Rays per side of a pixel."""
OFF_M = 1.5e-3
"""Rays that leave a surface begin so far above it [m]."""
CORNER_RAYS, CORNER_REACH_M, CORNER_BLUR_PX = 8, 0.6, 5
"""So many rays a pixel ask what near darkens it, so far [m]; their answers are averaged over so many pixels."""
LAMP = np.array([-0.35, -0.5, 0.79])
"""Where the light comes from, beside what is round about: a direction, as the sun's."""
AROUND, SUN = 0.66, 0.44
"""How bright they are; together a little above 1 where a surface faces the lamp."""
SHADOW_M = 1.2
"""Only what is so near casts a shadow, so that a ceiling does not darken all of a room [m]."""
EDGE_DARK, EDGE_JUMP = 0.25, 0.02
"""What lies at the edge of a thing is so dark; a jump in depth of so much of it is an edge, too."""
LAID_ON_M = 4e-3
PAPER = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Light:
    """A picture before lines and words.

    Args:
        rgb: linear, 0 to 1, shape (height, width, 3).
        depth_m: along the view, at pixels' middles; infinite where nothing opaque is, shape (height, width).
    """

    rgb: Array
    depth_m: NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class _Cast:
    """Where all rays of a picture meet the opaque layers.

    Args:
        scene: None: nothing is opaque.
        face: by sample, -1 for none, shape (height * smooth, width * smooth).
        far: along the ray [m].
        normals, colours, thing: by face.
    """

    scene: RayScene | None
    face: NDArray[np.int32]
    far: NDArray[np.float32]
    normals: Array
    colours: Array
    thing: NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class _Veil:
    """A translucent layer as rays meet it.

    Args:
        scene: its triangles.
        normals, colours: by triangle, shape (n, 3).
        opacity: 0 to 1.
    """

    scene: RayScene
    normals: Array
    colours: Array
    opacity: float

    def shade(self, face: NDArray[np.int32], ways: Array) -> Array:
        """The colour of a triangle as rays see it that come along some ways, shape (n, 3)."""
        face = np.maximum(face, 0)
        facing = np.abs(np.einsum("ij,ij->i", self.normals[face], ways))
        return np.asarray(self.colours[face] * (0.62 + 0.42 * facing)[:, None])


def cast(layers: Sequence[Layer], view: Viewpoint, smooth: int = SMOOTH) -> Light:
    """Draws layers.

    Args:
        layers: opaque and translucent ones.
        view: from where.
        smooth: rays per side of a pixel.
    """
    opaque = [layer for layer in layers if layer.opacity >= 1 and len(layer.triangles)]
    thin = [layer for layer in layers if layer.opacity < 1 and len(layer.triangles)]
    found = _cast(opaque, view, smooth)
    corners = _corners(found, view, smooth)
    rgb = np.empty((view.height, view.width, 3))
    veils = [
        _Veil(_scene(t := layer.triangles), normals_of(t), layer.colours, layer.opacity) for layer in thin
    ]
    for rows in _bands(view.height):
        origins, ways = view.rays(rows, smooth)
        samples = slice(rows.start * smooth, rows.stop * smooth)
        face, far = found.face[samples].ravel(), found.far[samples].ravel()
        bright = np.repeat(np.repeat(corners[rows], smooth, axis=0), smooth, axis=1).ravel()
        colours = _opaque(found, (origins, ways), face, far, bright)
        colours *= np.where(_edges(found, samples).ravel(), EDGE_DARK, 1.0)[:, None]
        colours = _through(colours, far, veils, origins, ways)
        band = colours.reshape(rows.stop - rows.start, smooth, view.width, smooth, 3)
        rgb[rows] = band.mean(axis=(1, 3))
    return Light(rgb, _depth(found, view, smooth))


def _cast(opaque: Sequence[Layer], view: Viewpoint, smooth: int) -> _Cast:
    shape = (view.height * smooth, view.width * smooth)
    face, far = np.full(shape, -1, np.int32), np.full(shape, np.inf, np.float32)
    if not opaque:
        return _Cast(None, face, far, np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, np.int32))
    triangles = np.concatenate([layer.triangles for layer in opaque])
    scene, first = _scene(triangles), 0
    things = []
    for layer in opaque:
        things.append(layer.thing + first)
        first += int(layer.thing.max(initial=0)) + 1
    for rows in _bands(view.height):
        hit, distance = scene.hits(*_floats(*view.rays(rows, smooth)))
        samples = slice(rows.start * smooth, rows.stop * smooth)
        face[samples] = hit.reshape(-1, shape[1])
        far[samples] = np.where(hit >= 0, distance, np.inf).reshape(-1, shape[1])
    colours = np.concatenate([layer.colours for layer in opaque])
    return _Cast(scene, face, far, normals_of(triangles), colours, np.concatenate(things))


def _corners(found: _Cast, view: Viewpoint, smooth: int) -> NDArray[np.float32]:
    """By pixel, how much of what is round about it sees, 0 to 1; averaged along each surface."""
    openness = np.ones((view.height, view.width), np.float32)
    if found.scene is None:
        return openness
    random = np.random.default_rng(0)
    for rows in _bands(view.height):
        face = found.face[_middles(rows, smooth), smooth // 2 :: smooth].ravel()
        seen = face >= 0
        origins, ways = (rays[seen] for rays in _one_a_pixel(view, rows, smooth))
        far = found.far[_middles(rows, smooth), smooth // 2 :: smooth].ravel()[seen]
        normal = _towards(found.normals[face[seen]], ways)
        point = origins + far[:, None] * ways + OFF_M * normal
        free = np.zeros(len(point))
        for _ in range(CORNER_RAYS):
            way = random.standard_normal(point.shape)
            way = normal * 1.001 + way / np.linalg.norm(way, axis=1, keepdims=True)
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            reach = found.scene.distances(*_floats(point, way), limits=np.full(len(point), CORNER_REACH_M))
            free += np.clip(reach / CORNER_REACH_M, 0.0, 1.0)
        band = np.ones(len(face), np.float32)
        band[seen] = free / CORNER_RAYS
        openness[rows] = band.reshape(-1, view.width)
    return _along_surfaces(openness, found, smooth)


def _along_surfaces(values: NDArray[np.float32], found: _Cast, smooth: int) -> NDArray[np.float32]:
    """Values averaged over the pixels about each that show the same thing, turned the same way."""
    face = found.face[smooth // 2 :: smooth, smooth // 2 :: smooth]
    turned = np.round(found.normals * 2).astype(np.int64) @ np.array([1, 7, 49])
    key = np.where(face >= 0, found.thing[face].astype(np.int64) * 1009 + turned[face], -1)
    total, count = np.zeros_like(values), np.zeros_like(values)
    half = CORNER_BLUR_PX // 2
    padded_key, padded = np.pad(key, half, constant_values=-2), np.pad(values, half)
    height, width = values.shape
    for down in range(2 * half + 1):
        for across in range(2 * half + 1):
            part = (slice(down, down + height), slice(across, across + width))
            same = padded_key[part] == key
            total += np.where(same, padded[part], 0)
            count += same
    return total / count


def _opaque(
    found: _Cast,
    rays: tuple[Array, Array],
    face: NDArray[np.int32],
    far: NDArray[np.float32],
    bright: NDArray[np.float32],
) -> Array:
    """The colour that each ray sees, linear, shape (n, 3)."""
    colours = np.full((len(face), 3), PAPER)
    seen = face >= 0
    if found.scene is None or not seen.any():
        return colours
    origins, ways = rays[0][seen], rays[1][seen]
    normal = _towards(found.normals[face[seen]], ways)
    point = origins + far[seen, None] * ways + OFF_M * normal
    sun = np.clip(normal @ LAMP, 0.0, 1.0)
    lit = sun > 0
    dark = np.zeros(len(sun), dtype=bool)
    lamp = np.broadcast_to(LAMP, (int(lit.sum()), 3))
    dark[lit] = found.scene.occluded(*_floats(point[lit], lamp), limits=np.full(len(lamp), SHADOW_M))
    light = AROUND * bright[seen] + SUN * np.where(dark, 0.0, sun)
    colours[seen] = found.colours[face[seen]] * light[:, None]
    return colours


def _edges(found: _Cast, samples: slice) -> NDArray[np.bool_]:
    """Samples at which one thing ends before another."""
    top, stop = max(samples.start - 1, 0), min(samples.stop + 1, len(found.face))
    face, far = found.face[top:stop], found.far[top:stop]
    thing = np.where(face >= 0, found.thing[face] if len(found.thing) else -1, -1)
    edge = np.zeros(face.shape, dtype=bool)
    for axis in (0, 1):
        one, other = _beside(thing, axis), _beside(far, axis)
        with np.errstate(invalid="ignore"):
            jump = np.abs(other[0] - other[1]) > EDGE_JUMP * np.minimum(other[0], other[1])
            nearer = other[0] <= other[1]
        differs = (one[0] != one[1]) & (jump | np.isinf(other[0]) | np.isinf(other[1]))
        low, high = _beside(edge, axis)
        low |= differs & nearer
        high |= differs & ~nearer
    return edge[samples.start - top : len(edge) - (stop - samples.stop)]


def _through(
    colours: Array, far: NDArray[np.float32], veils: Sequence[_Veil], origins: Array, ways: Array
) -> Array:
    """Colours with the fronts of translucent layers laid over them, the farthest first."""
    if not veils:
        return colours
    rays = _floats(origins, ways)
    hits = [veil.scene.hits(*rays) for veil in veils]
    distance = np.stack([np.where(face >= 0, t, np.inf) for face, t in hits])
    # what lies in an opaque surface is not before it
    distance = np.where(distance < far - LAID_ON_M, distance, np.inf)
    touched = np.isfinite(distance).any(axis=0)
    distance, behind = distance[:, touched], colours[touched]
    shades = np.stack([veil.shade(hits[n][0][touched], ways[touched]) for n, veil in enumerate(veils)])
    opacity = np.array([veil.opacity for veil in veils])
    ray = np.arange(len(behind))
    for place in np.argsort(-distance, axis=0, kind="stable"):
        part = np.where(np.isfinite(distance[place, ray]), opacity[place], 0.0)[:, None]
        behind = (1 - part) * behind + part * shades[place, ray]
    colours[touched] = behind
    return colours


def _depth(found: _Cast, view: Viewpoint, smooth: int) -> NDArray[np.float32]:
    middle = found.far[smooth // 2 :: smooth, smooth // 2 :: smooth]
    _, ways = _one_a_pixel(view, slice(0, view.height), smooth)
    forward = (ways @ view.world_from_view[:3, 2]).astype(np.float32)
    return np.asarray(middle * forward.reshape(middle.shape), dtype=np.float32)


def normals_of(triangles: Array) -> Array:
    """Normals of length 1, shape (n, 3)."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def _scene(triangles: Array) -> RayScene:
    return RayScene(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


def _bands(height: int) -> Iterator[slice]:
    return (slice(top, min(top + ROWS, height)) for top in range(0, height, ROWS))


def _middles(rows: slice, smooth: int) -> slice:
    return slice(rows.start * smooth + smooth // 2, rows.stop * smooth, smooth)


def _one_a_pixel(view: Viewpoint, rows: slice, smooth: int) -> tuple[Array, Array]:
    """The rays of those samples that stand for their pixels."""
    shape = (rows.stop - rows.start, smooth, view.width, smooth, 3)
    origins, ways = (rays.reshape(shape)[:, smooth // 2, :, smooth // 2] for rays in view.rays(rows, smooth))
    return origins.reshape(-1, 3), ways.reshape(-1, 3)


def _towards(normal: Array, ways: Array) -> Array:
    """Normals turned so that they face where the rays come from."""
    return np.where(np.einsum("ij,ij->i", normal, ways)[:, None] > 0, -normal, normal)


def _floats(one: Array, other: Array) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    return np.ascontiguousarray(one, dtype=np.float32), np.ascontiguousarray(other, dtype=np.float32)


def _beside(array: NDArray, axis: int) -> tuple[NDArray, NDArray]:
    """Views of each element but the last, and of the one after it, along an axis."""
    if axis == 0:
        return array[:-1], array[1:]
    return array[:, :-1], array[:, 1:]
