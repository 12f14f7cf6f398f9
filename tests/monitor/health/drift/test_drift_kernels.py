"""The watch's kernels say what plain NumPy says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.machine.rasterise import canvas, mesh_of, rasterise, view_of
from elbowroom.monitor.health.drift.body_view import BodyView
from elbowroom.monitor.health.drift.kernels import body as body
from elbowroom.monitor.health.drift.kernels import watch as kernels
from reference import machine_twins
from reference import watch_twins as naive


def spots_of(rng, n, pixels):
    return kernels.Spots(
        pixel=rng.permutation(pixels)[:n],
        depth=rng.uniform(0.5, 4, n),
        scale=rng.uniform(0.2, 1, n),
        sigma=rng.uniform(0.002, 0.03, n),
        jacobian=rng.normal(size=(n, 6)),
    )


@given(st.integers(0, 2**32 - 1))
def test_frames_are_averaged_as_by_hand(seed):
    rng = np.random.default_rng(seed)
    n, pixels = 40, 64
    spots = spots_of(rng, n, pixels)
    memory = kernels.Memory(np.zeros(n), np.zeros(n), np.zeros(n, np.int64), np.zeros(n, np.int64))
    before = [(0.0, 0.0, 0)] * n
    for _ in range(12):
        image = np.zeros(pixels, np.float32)
        image[spots.pixel] = spots.depth + rng.normal(0, rng.choice([0.005, 0.05, 0.5]), n)
        image[rng.integers(0, pixels, 6)] = rng.choice([np.nan, np.inf, 0.0, -1.0, 0.2, 60.0], 6)
        counts = kernels.listen(image, spots, kernels.Gate(0.3, 9.0, 0.2), memory)
        after, used, numbers = naive.listen(image, spots, 0.3, 9.0, 0.2, before)
        assert list(counts) == numbers and memory.used[: counts.within].tolist() == used
        for i, mean in enumerate(after):
            assert memory.frames[i] == (0 if mean is None else mean[2])
            if mean is not None:
                assert (memory.offset[i], memory.sigma[i]) == pytest.approx(mean[:2], abs=1e-12)
        before = [(0.0, 0.0, 0) if mean is None else mean for mean in after]


@given(st.integers(0, 2**32 - 1), st.sampled_from([0, 1, 5, 200]))
def test_the_fitted_motion_is_that_of_matrices(seed, n):
    rng = np.random.default_rng(seed)
    jacobian, sigma = rng.normal(size=(n + 3, 6)), rng.uniform(0.002, 0.03, n + 3)
    offset = jacobian @ rng.normal(0, 0.01, 6) + rng.normal(0, sigma) * rng.choice([1, 8], n + 3)
    used = np.sort(rng.permutation(n + 3)[:n])
    motion, covariance, *said = kernels.fit_motion(jacobian, offset, sigma, used, 0.1, 0.2)
    if n == 0:
        assert not motion.any() and not any(said)
        assert np.diag(covariance) == pytest.approx([0.01] * 3 + [0.04] * 3)
        return
    wanted = naive.fit_motion(jacobian[used], offset[used], sigma[used], 0.1, 0.2)
    assert motion == pytest.approx(wanted[0], abs=1e-9)
    assert covariance == pytest.approx(wanted[1], rel=1e-6, abs=1e-12)
    assert said[:2] == pytest.approx(wanted[2][:2], rel=1e-6, abs=1e-6)
    assert said[2:] == pytest.approx(wanted[2][2:], abs=1.5 / n)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    from elbowroom.machine import Machine

    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(machine_twins.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


AT_REST = {"slide": 0.1, "elbow": 0.4, "grip": 0.02}
VIEW = ((1.6, 0.5, 1.2), (0.1, 0, 0.5))


def test_links_drawn_one_by_one_are_the_machine_and_the_nearest_link_shows(arm):
    camera = machine_twins.camera_at(*VIEW)
    view, mesh = view_of(camera), mesh_of(arm)
    placed = camera.camera_from_world @ arm.world_from_link_array(arm.positions(AT_REST)[None])[0]
    empty = canvas(camera.height, camera.width)
    composite, shown = np.ones((120, 160), np.float32), np.zeros((120, 160), np.int16)
    body.draw_links(mesh, placed, view, empty, body.Shown(composite, shown))
    whole = rasterise(arm, camera, AT_REST)
    assert ((composite > 0) == np.isfinite(whole)).all() and ((shown >= 0) == np.isfinite(whole)).all()
    assert 1 / composite[shown >= 0] == pytest.approx(whole[shown >= 0], rel=1e-5)
    assert not empty[0].any() and (empty[1] == camera.width).all() and (empty[2] == -1).all()
    for number, link in enumerate(arm.links):
        if not link.has_geometry:
            assert not (shown == number).any()
            continue
        alone, _ = machine_twins.ray_cast(machine_twins.triangles_in_world(arm, AT_REST, [link.name]), camera)
        mine = shown == number
        # rays through an edge may meet it or miss it
        met = mine & np.isfinite(alone)
        assert met.sum() >= 0.98 * mine.sum() and np.abs(alone[met] - whole[met]).max(initial=0) < 1e-3


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_a_surface_that_is_seen_nearer_is_off_by_as_much_along_its_normal(arm, kind):
    camera = machine_twins.camera_at(*VIEW, depth_kind=kind)
    look = BodyView(camera, arm)
    placed = arm.world_from_link_array(arm.positions(AT_REST)[None])[0]
    depth = np.where(np.isfinite(model := rasterise(arm, camera, AT_REST)), model, 0).astype(np.float32)
    spots = look.look(depth, placed)
    assert len(spots.link) > 35
    assert np.abs(spots.offset_m).max() < 1e-4
    nearer = look.look(depth * np.float32(0.99), placed)
    # one hundredth of the way from the camera, as the normal sees it
    world = (
        np.einsum("nij,nj->ni", placed[nearer.link][:, :3, :3], nearer.point_in_link)
        + placed[nearer.link][:, :3, 3]
    )
    normal = np.einsum("nij,nj->ni", placed[nearer.link][:, :3, :3], nearer.normal_in_link)
    towards = 0.01 * np.sum((camera.centre_in_world - world) * normal, axis=1)
    assert nearer.offset_m == pytest.approx(towards, abs=1e-4)
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1.0)


def test_no_return_and_what_is_far_off_say_nothing_of_the_machine(arm):
    camera = machine_twins.camera_at(*VIEW)
    look = BodyView(camera, arm)
    placed = arm.world_from_link_array(arm.positions(AT_REST)[None])[0]
    for value in (0.0, np.nan, np.inf, 0.5, 8.0):
        assert len(look.look(np.full((120, 160), value, np.float32), placed).link) == 0
