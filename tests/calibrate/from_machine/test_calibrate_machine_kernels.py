import numpy as np
import pytest

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.kernels.surface import DepthError, Sums, compare
from elbowroom.calibrate.from_machine.surface_sums import TRUST
from elbowroom.machine.rasterise import view_of
from elbowroom.sensing.planar_images import planar_images
from reference import calibrate_surface
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
    sums = Sums(normal, gradient, counts, residuals)
    compare(view_of(images.thinned), drawing, images.depth_m[0], DepthError(0.004, 0.002), TRUST, sums)
    slow = calibrate_surface.compare(images.thinned, drawing.inverse, images.depth_m[0], 0.004, 0.002, TRUST)
    assert counts[1] > 50
    assert (counts == slow[2]).all()
    assert np.allclose(normal, slow[0], rtol=1e-5, atol=1e-5 * np.abs(slow[0]).max())
    assert np.allclose(gradient, slow[1], rtol=1e-5, atol=1e-5 * np.abs(slow[1]).max())
    assert np.isfinite(residuals).sum() == counts[1]
