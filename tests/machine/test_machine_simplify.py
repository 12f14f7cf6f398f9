"""Fine meshes made of fewer triangles: nobody may be farther off than is said."""

import numpy as np
import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

from elbowroom.machine import Link
from elbowroom.machine.kernels import simplify as kernels
from elbowroom.machine.simplify import BOUNDS_M, coarser
from reference import machine_twins as naive

seeds = st.integers(0, 2**32 - 1)


def rippled(seed, subdivisions=4):
    """A ball of 5,120 triangles with bumps, flat parts and creases."""
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.1)
    waves = rng.uniform(20, 90, (3, 3)), rng.uniform(0.0005, 0.006, 3)
    vertices = ball.vertices * (1 + (np.sin(ball.vertices @ waves[0]) * waves[1]).sum(axis=1) / 0.1)[:, None]
    vertices[:, 2] = np.clip(vertices[:, 2], -0.07, 0.05)
    return vertices, ball.faces


def apart(points, vertices, faces):
    """Distance of each point to triangles, by trimesh, each triangle asked.

    Its `proximity` asks those near the point's nearest corner alone, and may miss the nearest triangle.
    """
    corners = vertices[faces]
    return np.array(
        [
            np.linalg.norm(
                trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1
            ).min()
            for p in points
        ]
    )


def spread_over(vertices, faces, rng, count):
    """Random points of triangles, corners and middles of edges among them."""
    faces = faces[rng.integers(len(faces), size=count)]
    weights = np.concatenate([rng.dirichlet((0.5, 0.5, 0.5), count - 20), np.repeat(np.eye(3), 5, axis=0)])
    weights = np.concatenate([weights, np.full((5, 3), [0.5, 0.5, 0])])
    return np.einsum("nc,nck->nk", weights, vertices[faces])


@settings(max_examples=4)
@given(seeds)
def test_fine_and_coarse_surfaces_lie_within_the_bound_of_each_other(seed):
    vertices, faces = rippled(seed)
    rng = np.random.default_rng(seed)
    fine, *coarse = coarser(Link("ball", vertices, faces))
    sizes = [len(fine.faces), *(len(link.faces) for link in coarse)]
    assert sizes == sorted(sizes, reverse=True) and sizes[-1] < 0.4 * sizes[0]
    for bound, link in zip(BOUNDS_M, coarse, strict=True):
        there = spread_over(vertices, faces, rng, 120)
        assert apart(there, link.vertices, link.faces).max() <= bound
        back = spread_over(link.vertices, link.faces, rng, 120)
        assert apart(back, vertices, faces).max() <= bound


@settings(max_examples=5)
@given(seeds)
def test_a_closed_surface_stays_closed_and_what_is_well_inside_stays_inside(seed):
    vertices, faces = rippled(seed)
    turned = np.where(np.random.default_rng(seed).random((len(faces), 1)) < 0.5, faces[:, ::-1], faces)
    link = coarser(Link("ball", vertices, turned if seed % 2 else faces))[-1]
    mesh = trimesh.Trimesh(link.vertices, link.faces, process=False)
    edges = np.sort(mesh.edges, axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    if not seed % 2:
        assert mesh.is_watertight and mesh.is_winding_consistent
        assert mesh.volume == pytest.approx(
            trimesh.Trimesh(vertices, faces).volume, abs=mesh.area * BOUNDS_M[-1]
        )


@settings(max_examples=5)
@given(seeds)
def test_a_soup_of_any_triangles_is_covered_too(seed):
    # open, crossing, doubled, turned over, without area, corners at one place and not joined
    rng = np.random.default_rng(seed)
    vertices, faces = rippled(seed, subdivisions=2)
    faces = faces[rng.random(len(faces)) > 0.1]
    faces = np.where(rng.random((len(faces), 1)) < 0.2, faces[:, ::-1], faces)
    loose = rng.uniform(-0.1, 0.1, (30, 3))
    lost = rng.integers(len(vertices), len(vertices) + 30, (40, 3))
    vertices, faces = np.concatenate([vertices, loose]), np.concatenate([faces, faces[:20], lost])
    if seed % 2:
        vertices, faces = vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)
    link = coarser(Link("soup", vertices, faces))[-1]
    assert len(link.faces) < len(faces)
    assert apart(spread_over(vertices, faces, rng, 60), link.vertices, link.faces).max() <= BOUNDS_M[-1]
    assert apart(spread_over(link.vertices, link.faces, rng, 60), vertices, faces).max() <= BOUNDS_M[-1]


def test_flat_sides_cut_into_many_triangles_need_few_again():
    box = trimesh.creation.box((0.3, 0.2, 0.1)).subdivide().subdivide().subdivide().subdivide()
    vertices = box.vertices + 0.0
    first, *coarse = coarser(Link("box", vertices, box.faces))
    assert len(first.faces) == 3072
    assert len(coarse[-1].faces) <= 40
    for link in coarse:
        mesh = trimesh.Trimesh(link.vertices, link.faces)
        assert mesh.is_watertight and mesh.volume == pytest.approx(0.006)


def test_corners_at_one_place_are_one_corner():
    vertices, faces = rippled(3)
    apart_too = Link("loose", vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    joined = coarser(Link("joined", vertices, faces))[-1]
    assert len(coarser(apart_too)[-1].faces) == pytest.approx(len(joined.faces), rel=0.1)


def test_a_link_of_few_triangles_or_none_stays_as_it_is():
    box = trimesh.creation.box((0.3, 0.2, 0.1))
    for link in (Link("box", box.vertices, box.faces), Link("none", np.zeros((0, 3)), np.zeros((0, 3)))):
        assert coarser(link) == (link,)


@settings(max_examples=15)
@given(seeds, st.integers(3, 9))
@example(5640, 9)  # a peak between all of 80 places
def test_how_far_a_fan_lies_off_is_the_greatest_difference_in_height(seed, corners):
    rng = np.random.default_rng(seed)
    angles = (np.arange(corners) + rng.uniform(0.3, 0.7, corners)) * 2 * np.pi / corners
    away = rng.uniform(0.3, 1, corners)
    ring = np.column_stack([away * np.cos(angles), away * np.sin(angles), rng.uniform(-1, 1, corners)])
    places = [p for p in range(corners) if kernels._quality(ring, corners, p) >= kernels.LEAST_QUALITY]
    for place in places:
        found = kernels._moved(ring, corners, place, np.inf)
        # a peak may be narrow: where few places miss it, many are looked at
        for count in (80, 8000):
            looked = naive.fan_rise(ring, place, rng, count)
            assert found >= looked - 1e-9
            if found <= looked + 0.02:
                break
        assert found <= looked + 0.02


def test_a_fold_is_no_fan():
    # the second corner stands in the way of the first and the third
    ring = np.array([[1, 0, 0], [0.2, 0.2, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], dtype=float)
    good = [kernels._quality(ring, 5, place) >= kernels.LEAST_QUALITY for place in range(5)]
    assert good == [False, True, False, True, True]
