"""Rays meet the same triangles by Embree and by the tree that takes its place."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import ray_scene
from elbowroom.geometry.ray_scene import NOWHERE, RayScene


@pytest.fixture
def without_embree(monkeypatch):
    monkeypatch.setattr(ray_scene, "_embree", lambda: None)


def rays(seed, count=500):
    random = np.random.default_rng(seed)
    origins = random.uniform(-2, 2, (count, 3))
    return origins, random.standard_normal((count, 3))


def first_hits(corners, origins, directions):
    """Obviously right: each ray against each triangle's plane and edges."""
    found = np.full(len(origins), np.inf)
    for n, (origin, way) in enumerate(zip(origins, directions, strict=True)):
        for a, b, c in corners:
            normal = np.cross(b - a, c - a)
            if abs(normal @ way) < 1e-12:
                continue
            distance = normal @ (a - origin) / (normal @ way)
            point = origin + distance * way
            inside = all(np.cross(q - p, point - p) @ normal >= 0 for p, q in ((a, b), (b, c), (c, a)))
            if distance >= 0 and inside:
                found[n] = min(found[n], distance)
    return found


@given(seed=st.integers(0, 10_000), triangles=st.integers(1, 40))
@settings(max_examples=15)
def test_the_tree_finds_what_every_triangle_asked_one_by_one_finds(seed, triangles):
    corners = np.random.default_rng(seed).uniform(-1, 1, (triangles, 3, 3)).astype(np.float32)
    origins, directions = rays(seed, 40)
    distances, hit = np.empty(40), np.empty(40, np.int64)
    ray_scene.meet(
        ray_scene.tree_of(corners.astype(float)), origins, directions, np.full(40, 1e37), distances, hit
    )
    due = first_hits(corners.astype(float), origins, directions)
    assert np.array_equal(hit >= 0, np.isfinite(due))
    np.testing.assert_allclose(distances[hit >= 0], due[np.isfinite(due)], rtol=1e-9)


def test_both_ways_meet_the_same_of_a_closed_body(monkeypatch):
    pytest.importorskip("embreex")
    body = trimesh.creation.icosphere(3, 0.8)
    origins, directions = rays(1)
    embree = RayScene(body.vertices, body.faces)
    monkeypatch.setattr(ray_scene, "_embree", lambda: None)
    tree = RayScene(body.vertices, body.faces)
    (hit_a, far_a), (hit_b, far_b) = (scene.hits(origins, directions) for scene in (embree, tree))
    assert np.array_equal(hit_a >= 0, hit_b >= 0) and (hit_a == hit_b).mean() > 0.99
    np.testing.assert_allclose(far_a, far_b, rtol=1e-4)
    limits = np.full(len(origins), 0.5)
    assert np.array_equal(*(scene.occluded(origins, directions, limits) for scene in (embree, tree)))
    np.testing.assert_allclose(
        *(scene.distances(origins, directions, limits) for scene in (embree, tree)), rtol=1e-4
    )


def test_no_ray_slips_between_two_triangles_that_share_an_edge(without_embree):
    cells = 8
    x, y = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1))
    vertices = np.stack([x, y, np.ones_like(x)], -1).reshape(-1, 3)
    at = np.arange((cells + 1) * cells).reshape(cells, -1)[:, :-1].ravel()
    faces = np.concatenate(
        [np.stack([at, at + 1, at + cells + 2], -1), np.stack([at, at + cells + 2, at + cells + 1], -1)]
    )
    aim = np.linspace(-0.999, 0.999, 81)
    ways = np.stack([*np.meshgrid(aim, aim), np.ones((81, 81))], -1).reshape(-1, 3)
    distances = RayScene(vertices, faces).distances(np.zeros_like(ways), ways)
    assert distances.max() < 1.0 + 1e-6


def test_nothing_is_nowhere_and_a_limit_stays(without_embree):
    scene = RayScene(np.zeros((0, 3)), np.zeros((0, 3), int))
    one = np.ones((1, 3))
    assert scene.distances(one, one)[0] == NOWHERE
    assert scene.distances(one, one, np.array([0.25]))[0] == 0.25
    assert scene.hits(one, one)[0][0] == -1 and not scene.occluded(one, one, np.ones(1))[0]
