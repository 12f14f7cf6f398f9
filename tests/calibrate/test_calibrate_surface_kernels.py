import numpy as np
import pytest

from elbowroom.calibrate._kernels_overlap import Overlap, compare_points, fit_planes
from elbowroom.calibrate._kernels_surface import compare
from elbowroom.calibrate.drawn_machine import DrawnMachine
from elbowroom.calibrate.overlap import surfaces
from elbowroom.calibrate.planar_images import planar_images
from elbowroom.calibrate.surface_sums import TRUST
from elbowroom.geometry import invert_rigid
from elbowroom.machine.rasterise import view_of
from reference import calibrate_overlap, calibrate_surface
from reference.calibrate_machines import PLACES, camera, poses_of, record, room, roughly


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("noise", ["kinect_v1", None])
def test_surface_sums_are_those_of_the_twin(kind, noise):
    place = room()
    true = camera("north", *PLACES["north"], noise=noise, width=128, depth_kind=kind)
    (moment,) = record([true], poses_of(place, 1))
    (rough,) = roughly([true], 3, metres=0.01, degrees=0.3)
    images = planar_images(rough, moment.frames)
    machine = place.machine
    links = machine.world_from_link_array(machine.positions(moment.joints)[None])[0]
    drawing = DrawnMachine(machine, np.eye(4)).image(images.thinned, links)
    normal, gradient, counts = np.zeros((8, 8)), np.zeros(8), np.zeros(5, dtype=np.int64)
    residuals = np.full(drawing.inverse.shape, np.nan, dtype=np.float32)
    compare(
        view_of(images.thinned), *drawing, images.depth_m[0], 0.004, 0.002, TRUST, normal, gradient, counts, residuals
    )  # fmt: skip
    slow = calibrate_surface.compare(images.thinned, drawing.inverse, images.depth_m[0], 0.004, 0.002, TRUST)
    assert counts[1] > 50
    assert (counts == slow[2]).all()
    assert np.allclose(normal, slow[0], rtol=1e-5, atol=1e-5 * np.abs(slow[0]).max())
    assert np.allclose(gradient, slow[1], rtol=1e-5, atol=1e-5 * np.abs(slow[1]).max())
    assert np.isfinite(residuals).sum() == counts[1]


def test_planes_are_those_of_the_twin():
    true = camera("north", *PLACES["north"], width=64)
    (moment,) = record([true], poses_of(room(), 1))
    depth = planar_images(true, moment.frames).depth_m[0]
    k = true.intrinsics
    planes = np.zeros((*depth.shape, 3), dtype=np.float32)
    fit_planes(depth, k.fx, k.fy, k.cx, k.cy, 1, 0.02, planes)
    assert planes.any(axis=-1).mean() > 0.2
    for v, u in np.ndindex(depth.shape):
        slow = calibrate_overlap.fit_plane(depth, u, v, true, 1, 0.02)
        assert np.allclose(planes[v, u], np.zeros(3) if slow is None else slow, atol=1e-5)


def test_overlap_sums_are_those_of_the_twin():
    one, other = (camera(name, *PLACES[name], width=64) for name in ("north", "east"))
    (moment,) = record([one, other], poses_of(room(), 1))
    a, b = (
        surfaces(planar_images(c, [frame]), [0]) for c, frame in zip((one, other), moment.frames, strict=True)
    )
    rule = Overlap(gate_m=0.1, reach=4.7, floor_m=0.002, least_cosine=0.6, tiles=3, arm_px=7.0)
    other_from_one = invert_rigid(other.world_from_camera) @ one.world_from_camera
    normal, gradient, counts = np.zeros((9, 6, 6)), np.zeros((9, 6)), np.zeros(4, dtype=np.int64)
    offs, by_noise = np.full(len(a.points[0].points), np.nan), np.zeros((6, 6))
    compare_points(
        view_of(b.images.thinned), b.images.depth_m[0], b.planes[0], *a.points[0], other_from_one, rule,
        normal, gradient, by_noise, counts, offs,
    )  # fmt: skip
    slow = calibrate_overlap.compare_points(
        other, b.images.depth_m[0], b.planes[0], *a.points[0], other_from_one, rule
    )
    assert counts[1] > 100
    assert (counts == slow[2]).all()
    assert np.allclose(normal.sum(axis=0), slow[0], rtol=1e-6, atol=1e-6 * np.abs(slow[0]).max())
    assert np.allclose(gradient.sum(axis=0), slow[1], rtol=1e-6, atol=1e-6 * np.abs(slow[1]).max())
    assert np.allclose(by_noise, slow[3], rtol=1e-6, atol=1e-6 * np.abs(slow[3]).max())
    assert (normal.any(axis=(1, 2))).sum() > 1
