"""Scenes for calibration from the machine and refinement: small images, few cameras."""

from dataclasses import replace

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.geometry.twist import between, exp, sizes
from elbowroom.sensing import NOISE_PRESETS, Snapshot
from elbowroom.simulate import InterventionRoom, render

PLACES = {
    "north": ((0.3, 1.9, 2.3), (0.0, 0.0, 1.3)),
    "east": ((1.95, 0.4, 2.2), (0.0, 0.0, 1.2)),
    "west": ((-1.9, -1.2, 1.9), (0.2, 0.1, 1.2)),
}


def camera(name, position_m, look_at_m, *, noise="kinect_v1", width=160, **more):
    focal = width / 2
    height = width * 3 // 4
    return DepthCamera(
        name=name,
        width=width,
        height=height,
        world_from_camera=looking_at(position_m, look_at_m),
        intrinsics=Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2),
        noise=NOISE_PRESETS[noise] if noise else None,
        min_depth_m=0.2,
        max_depth_m=8.0,
        **more,
    )


def cameras(noise="kinect_v1", width=160):
    return tuple(camera(name, *place, noise=noise, width=width) for name, place in PLACES.items())


def poses_of(room, count, seed=0):
    """Moments of a room whose machine goes through poses; people walk meanwhile."""
    rng = np.random.default_rng(seed)
    return [room.random_moment(rng) for _ in range(count)]


def record(true_cameras, moments, *, noise=True, seed=0):
    """What the cameras deliver, with joints, as a recording gives it."""
    return [
        Snapshot(
            tuple(render(true_cameras, moment, noise=noise, seed=seed)),
            dict(moment.joints),
            now_ns=moment.stamp_ns,
        )
        for moment in moments
    ]


def roughly(true_cameras, seed, metres=0.1, degrees=5.0):
    """The same cameras with poses that are off by this much, each in a direction of its own."""
    rng = np.random.default_rng(seed)
    found = []
    for one in true_cameras:
        turn, way = rng.standard_normal(3), rng.standard_normal(3)
        twist = np.concatenate(
            [np.radians(degrees) * turn / np.linalg.norm(turn), metres * way / np.linalg.norm(way)]
        )
        found.append(replace(one, world_from_camera=one.world_from_camera @ exp(twist)))
    return tuple(found)


def errors(found, true_cameras):
    """By camera: metres, degrees, and squared Mahalanobis distance of the truth."""
    truth = {one.name: one.world_from_camera for one in true_cameras}
    result = {}
    for one in found:
        twist = between(one.camera.world_from_camera, truth[one.camera.name])
        metres, radians = sizes(twist)
        result[one.camera.name] = (
            metres,
            float(np.degrees(radians)),
            float(twist @ np.linalg.solve(one.covariance, twist)),
        )
    return result


def room(**more):
    return InterventionRoom(**more)
