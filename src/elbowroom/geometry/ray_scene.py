"""Where rays meet triangles: by Embree where it is installed, else by a tree of boxes of our own."""

from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kernels.ray_tree import DEPTH, LEAF, Tree, meet
from elbowroom.geometry.parallel import spread, thread_count

NOWHERE = np.float32(1e37)
"""What is said of a ray that meets nothing, if it had no limit."""
RAYS_AT_LEAST = 4096
"""A thread is not worth fewer."""


class RayScene:
    """Triangles that rays are cast at. Both sides count.

    Embree (Wald et al., 2014) has no wheels for ARM, where the tree takes its place: it takes several times as long
    (docs/benchmarks.md), and works in float64 where Embree works in float32.

    Args:
        vertices: shape (n, 3) [m].
        faces: whole numbers, shape (m, 3).
    """

    def __init__(self, vertices: NDArray[Any], faces: NDArray[Any]) -> None:
        corners = np.ascontiguousarray(vertices, dtype=np.float32)
        triangles = np.ascontiguousarray(faces, dtype=np.int32)
        self._embree = embree_scene(corners, triangles)
        self._tree = tree_of(corners[triangles].astype(np.float64)) if self._embree is None else None

    def distances(
        self, origins: NDArray[Any], directions: NDArray[Any], limits: NDArray[Any] | None = None
    ) -> NDArray[np.float32]:
        """How far each ray goes, in multiples of its direction's length, shape (n,).

        Args:
            origins, directions: shape (n, 3) [m].
            limits: shape (n,), beyond which nothing counts; None: none.

        Returns:
            The limit where nothing is met before it, `NOWHERE` where there was none.
        """
        if self._embree is not None:
            known = {} if limits is None else {"dists": np.ascontiguousarray(limits, dtype=np.float32)}
            found = self._embree.run(_floats(origins), _floats(directions), query="DISTANCE", **known)
            return np.asarray(found, dtype=np.float32)
        return self._meet(origins, directions, limits)[0].astype(np.float32)

    def hits(
        self, origins: NDArray[Any], directions: NDArray[Any]
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Which triangle each ray meets first, -1 for none, and how far it goes, as of `distances`.

        Args:
            origins, directions: shape (n, 3) [m].
        """
        if self._embree is not None:
            found = self._embree.run(_floats(origins), _floats(directions), output=True)
            return found["primID"], found["tfar"]
        distances, triangles = self._meet(origins, directions, None)
        return triangles.astype(np.int32), distances.astype(np.float32)

    def occluded(
        self, origins: NDArray[Any], directions: NDArray[Any], limits: NDArray[Any]
    ) -> NDArray[np.bool_]:
        """Whether each ray meets anything before its limit, shape (n,).

        Args:
            origins, directions: shape (n, 3) [m].
            limits: shape (n,), in multiples of the directions' lengths.
        """
        if self._embree is not None:
            far = np.ascontiguousarray(limits, dtype=np.float32)
            found = self._embree.run(_floats(origins), _floats(directions), dists=far, query="OCCLUDED")
            return np.asarray(found) >= 0
        return self._meet(origins, directions, limits)[1] >= 0

    def _meet(
        self, origins: NDArray[Any], directions: NDArray[Any], limits: NDArray[Any] | None
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Distances and triangles by the tree."""
        count = len(directions)
        starts, ways = (
            np.ascontiguousarray(np.broadcast_to(a, (count, 3)), np.float64) for a in (origins, directions)
        )
        far = np.full(count, NOWHERE, np.float64) if limits is None else np.asarray(limits, np.float64)
        distances, triangles = np.empty(count), np.empty(count, np.int64)
        shares = max(1, min(thread_count(), count // RAYS_AT_LEAST))
        bounds = np.linspace(0, count, shares + 1).astype(int)

        def cast(share: int) -> None:
            part = slice(bounds[share], bounds[share + 1])
            assert self._tree is not None
            meet(self._tree, starts[part], ways[part], far[part], distances[part], triangles[part])

        spread(cast, range(shares))
        return distances, triangles


def embree_scene(corners: NDArray[np.float32], triangles: NDArray[np.int32]) -> Any:
    """Embree's scene of these triangles; None where Embree is not installed."""
    found = _embree()
    if found is None:
        return None
    construction, core, device = found
    scene = core.EmbreeScene(device)
    construction.TriangleMesh(scene, corners, triangles)
    return scene


@cache
def _embree() -> tuple[Any, Any, Any] | None:
    """Its modules, and one device for all scenes.

    A scene that is given none makes one of its own, and ends it when it goes: while another thread cast rays, that
    crashed the process now and then.
    """
    try:
        construction, core = import_module("embreex.mesh_construction"), import_module("embreex.rtcore_scene")
        return construction, core, import_module("embreex.rtcore").EmbreeDevice()
    except ImportError:
        return None


def _floats(array: NDArray[Any]) -> NDArray[np.float32]:
    """As Embree takes it; an array that has that type already is not copied, whatever its strides."""
    return np.asarray(array, dtype=np.float32)


def tree_of(corners: NDArray[np.float64]) -> Tree:
    """Hangs triangles in a tree of boxes, halved by number along the longest side of their middles.

    Args:
        corners: shape (n, 3, 3) [m].
    """
    least, most, middles = corners.min(axis=1), corners.max(axis=1), corners.mean(axis=1)
    order = np.arange(len(corners))
    first, stop, halves = [0], [len(corners)], [-1]
    lower, upper = [np.zeros(3)], [np.zeros(3)]
    box = 0
    while box < len(first):
        own = order[first[box] : stop[box]]
        if len(own):
            lower[box], upper[box] = least[own].min(axis=0), most[own].max(axis=0)
        if len(own) > LEAF:
            axis = int(np.argmax(np.ptp(middles[own], axis=0)))
            half = len(own) // 2
            order[first[box] : stop[box]] = own[np.argpartition(middles[own, axis], half)]
            halves[box] = len(first)
            between = first[box] + half
            first += [first[box], between]
            stop += [between, stop[box]]
            halves += [-1, -1]
            lower += [np.zeros(3), np.zeros(3)]
            upper += [np.zeros(3), np.zeros(3)]
        box += 1
    assert len(corners) < 2 ** (DEPTH - 4)
    bounds = np.array(lower), np.array(upper)
    return Tree(corners, order, np.array(first), np.array(stop), np.array(halves), *bounds)
