"""How far a body presses what stands in the voxels that it reaches into: it ends before that is more than a hair."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.motion import Level, Motion, check_motion
from elbowroom.motion.kernels.outward import CORNERS, _most_of_cut
from elbowroom.motion.outward import PRESSED_M, SHARPEST, _outward, _sharp
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.simulate.shapes import box, ellipsoid, join
from reference import contact_machines as contacts
from reference import motion_outward as naive
from reference.motion_machines import room, touched_by_box

GRID = room(0.05)


def triangles_of(shape):
    mesh = join([shape])
    return mesh.vertices[mesh.faces].astype(np.float64)


@settings(max_examples=100)
@given(st.integers(0, 9999))
def test_a_triangle_moves_outward_in_a_box_as_much_as_at_its_places_there(seed):
    rng = np.random.default_rng(seed)
    triangle, moved = rng.uniform(-1, 2, (3, 3)), rng.uniform(-1, 1, 3)
    found = _most_of_cut(triangle, moved, (0.0, 0.0, 0.0), 1.0, np.empty((2, CORNERS, 4)))
    sampled = naive.most_in(triangle, moved, (0.0, 0.0, 0.0), 1.0)
    assert sampled - 1e-12 <= found
    # between two of its places it is no greater than a step of it allows
    near = naive.most_in(triangle, moved, (-0.1, -0.1, -0.1), 1.2)
    assert found <= near + 1e-12 or found <= 0.1


def test_normals_are_outward_and_open_surfaces_have_none():
    for shape in (box((0, 0, 0), (1, 2, 3)), ellipsoid((1, 1, 1), (0.5, 0.4, 0.3))):
        for piece in (triangles_of(shape), triangles_of(shape)[:, ::-1]):
            outward, sided = _outward(piece)
            normal = np.cross(outward[:, 1] - outward[:, 0], outward[:, 2] - outward[:, 0])
            away = outward.mean(axis=1) - outward.mean(axis=(0, 1))
            assert sided and (np.einsum("ni,ni->n", normal, away) > 0).all()
        assert not _outward(triangles_of(shape)[1:])[1]


def test_edges_are_as_sharp_as_they_are():
    cornered = _sharp(triangles_of(box((0, 0, 0), (1, 2, 3))))
    assert cornered == pytest.approx(np.sqrt(3), rel=0.05)
    round_ = _sharp(triangles_of(ellipsoid((0, 0, 0), (0.5, 0.5, 0.5), 24, 40)))
    assert round_.min() >= 1.0 and round_.max() < 1.1
    flat = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 0, 0]]], dtype=float)
    assert (_sharp(flat) == SHARPEST).all()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A prism of 24 sides, of 20 cm radius, that turns about its own axis: its edges stand out by 1.7 mm."""
    return contacts.machine(
        tmp_path_factory.mktemp("wheel"),
        contacts.link("base", (0.1, 0.1, 0.1), (0, 0, -0.2)),
        PRISM.format(mesh=_prism(tmp_path_factory.mktemp("mesh") / "prism.stl")),
        contacts.joint("turn", "base", "wheel", axis="0 0 1"),
    )


PRISM = (
    '<link name="wheel"><collision><origin xyz="0 0 0.4"/>'
    '<geometry><mesh filename="{mesh}"/></geometry></collision></link>'
)


def _prism(path):
    import trimesh

    trimesh.creation.cylinder(0.2, 0.3, sections=24).export(path)
    return path


@pytest.mark.parametrize("gap", [0.0003, 0.001])
def test_a_round_link_that_turns_does_not_press_what_is_beside_a_facet_of_it(wheel, gap):
    # half a step from an edge: the middle of a facet, which lies inward of the edges
    flat = 0.2 * np.cos(np.pi / 24)
    wall = touched_by_box(GRID, (flat + gap, -1, 0), (0.4, 1, 1))
    space = FreeSpace.from_occupied(GRID, wall)
    start = {"turn": np.pi / 24 if _edge_at_zero(wheel) else 0.0}
    for way in (1, -1):
        verdict = check_motion(space, wheel, start, Motion("turn", way, 0.1))
        assert _outermost(wheel, start["turn"] + way * verdict.free_travel) <= flat + gap
        assert verdict.level is Level.STOP
    assert PRESSED_M < 0.0003


def _edge_at_zero(wheel):
    return _outermost(wheel, 0.0) > 0.1999


def _outermost(wheel, turn):
    link = wheel.links[wheel.link_names.index("wheel")]
    c, s = np.cos(turn), np.sin(turn)
    return float((link.vertices[:, 0] * c - link.vertices[:, 1] * s).max())
