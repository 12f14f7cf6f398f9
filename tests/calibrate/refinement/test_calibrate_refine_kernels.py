import numpy as np

from elbowroom.calibrate.refinement.kernels.overlap import Overlap, Sums, Surface, compare_points, fit_planes
from elbowroom.calibrate.refinement.overlap import surfaces
from elbowroom.geometry import invert_rigid
from elbowroom.machine.rasterise import view_of
from elbowroom.sensing.planar_images import planar_images
from reference import calibrate_overlap
from reference.calibrate_machines import PLACES, camera, poses_of, record, room


def test_planes_are_those_of_the_twin():
    true = camera("north", *PLACES["north"], width=64)
    (moment,) = record([true], poses_of(room(), 1))
    depth = planar_images(true, moment.frames).depth_m[0]
    planes = np.zeros((*depth.shape, 3), dtype=np.float32)
    fit_planes(depth, view_of(true), 1, 0.02, planes)
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
    sums = Sums(np.zeros((9, 6, 6)), np.zeros((9, 6)), np.zeros((6, 6)), np.zeros(4, dtype=np.int64))
    normal, gradient, by_noise, counts = sums
    offs = np.full(len(a.points[0].points), np.nan)
    surface = Surface(b.images.depth_m[0], b.planes[0])
    compare_points(view_of(b.images.thinned), surface, a.points[0], other_from_one, rule, sums, offs)
    slow = calibrate_overlap.compare_points(
        other, b.images.depth_m[0], b.planes[0], *a.points[0], other_from_one, rule
    )
    assert counts[1] > 100
    assert (counts == slow[2]).all()
    assert np.allclose(normal.sum(axis=0), slow[0], rtol=1e-6, atol=1e-6 * np.abs(slow[0]).max())
    assert np.allclose(gradient.sum(axis=0), slow[1], rtol=1e-6, atol=1e-6 * np.abs(slow[1]).max())
    assert np.allclose(by_noise, slow[3], rtol=1e-6, atol=1e-6 * np.abs(slow[3]).max())
    assert (normal.any(axis=(1, 2))).sum() > 1
