"""References of cameras with a distorted lens, and of the simulated room with its machine."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import Intrinsics
from elbowroom.machine.rasterise import rasterise
from elbowroom.monitor import Watch
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.flat_spots import flat_spots
from elbowroom.sensing import Snapshot, rectified
from elbowroom.sensing.rays import pixel_rays
from elbowroom.simulate import InterventionRoom, Optics, render, wall_cameras
from elbowroom.simulate.knock import Knock

DISTORTION = (-0.12, 0.03, 0.001, -0.001, 0.0)


@pytest.fixture(scope="module")
def distorted():
    """Two cameras with barrel distortion in the room with its machine, and their references."""
    straight = wall_cameras(2, 2.4, 160, 120, optics=Optics(hfov_deg=70))
    cameras = [
        replace(c, intrinsics=replace(c.intrinsics, distortion=DISTORTION), max_depth_m=8.0) for c in straight
    ]
    room = InterventionRoom(people=False)
    commissioning = Commissioning(cameras, room.machine, 5)
    for number in range(5):
        moment = room.at(3.0 * number)
        commissioning.add(Snapshot.taken(render(cameras, moment, seed=number), moment.joints))
    return room, cameras, commissioning.references()


def test_spots_of_a_distorted_camera_lie_where_its_rays_meet_the_room(distorted):
    room, cameras, references = distorted
    moment = room.at(1.0)
    for camera, reference, frame in zip(cameras, references, render(cameras, moment), strict=True):
        x, y = np.divmod(reference.pixel, camera.width)[::-1]
        rays = pixel_rays(camera)
        assert reference.ray == pytest.approx(np.column_stack([rays.x[y, x], rays.y[y, x]]), abs=1e-6)
        away = np.abs(frame.depth_m.ravel()[reference.pixel] - reference.depth_m)
        # the machine hides some of them now
        assert np.median(away) < 0.003 and (away < 0.03).mean() > 0.8


def test_the_machine_is_in_no_reference_of_a_distorted_camera(distorted):
    room, cameras, references = distorted
    for camera, reference in zip(cameras, references, strict=True):
        pinhole, at_rest = rectified(camera), room.at(0.0).joints
        model = rasterise(room.machine, pinhole, at_rest)
        u = np.round(reference.ray[:, 0] * pinhole.intrinsics.fx + pinhole.intrinsics.cx).astype(int)
        v = np.round(reference.ray[:, 1] * pinhole.intrinsics.fy + pinhole.intrinsics.cy).astype(int)
        inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        behind = np.isfinite(model[v[inside], u[inside]])
        # it stood there in one of five moments: what was seen then is the wall at other moments, never the machine
        assert (reference.depth_m[inside][behind] > model[v[inside], u[inside]][behind]).all()


@pytest.mark.parametrize("number", [0, 1])
def test_a_distorted_camera_that_is_knocked_is_named_and_the_machine_is_not(distorted, number):
    room, cameras, references = distorted
    watch = Watch(cameras, references, room.machine)
    truly = list(cameras)
    truly[number] = Knock("", (0, float(np.radians(1.0)), 0)).camera(cameras[number])
    for k in range(60):
        moment = room.at(20 + k / 30)
        health = watch.hear(Snapshot.taken(render(truly, moment), moment.joints, moment.stamp_ns))
    assert list(health.stops) == [cameras[number].name]
    assert watch.shift_of(cameras[number].name).turn_deg == pytest.approx(1.0, abs=0.15)


def test_a_plane_is_flat_everywhere_and_its_normal_is_the_planes():
    k = Intrinsics(80, 80, 79.5, 59.5)
    x, y = np.meshgrid(*k.normalised(160, 120))
    normal = np.array((0.3, -0.5, -0.8)) / np.linalg.norm((0.3, -0.5, -0.8))
    depth = -2.0 / (normal[0] * x + normal[1] * y + normal[2])
    depth[(depth < 0) | (depth > 9)] = 0.0
    found = flat_spots(depth, x, y, np.zeros_like(depth))
    assert found.flat.sum() > 0.7 * (depth > 0).sum()
    assert found.normal[found.flat] == pytest.approx(np.broadcast_to(normal, (found.flat.sum(), 3)), abs=1e-6)
    assert found.planar_m[found.flat] == pytest.approx(depth[found.flat], rel=1e-6)


def test_edges_and_what_is_not_seen_are_not_flat():
    k = Intrinsics(80, 80, 79.5, 59.5)
    x, y = np.meshgrid(*k.normalised(160, 120))
    depth = np.where(x < 0, 2.0, 2.5)
    depth[50:60, 20:30] = 0.0
    flat = flat_spots(depth, x, y, np.zeros_like(depth)).flat
    assert not flat[:, 78:82].any() and not flat[48:62, 18:32].any() and not flat[[0, -1]].any()
    assert flat[20, 30] and flat[20, 130]
