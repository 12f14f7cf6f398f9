"""A camera before a room of walls, with noise: images as a sensor gives them, one after the other."""

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.sensing import DepthFrame, Snapshot

STEP_NS = 66_000_000
T0_NS = 10_000_000_000


def a_camera(name="c0", width=64, height=48):
    """A pinhole of 90 degrees."""
    k = Intrinsics(width / 2, width / 2, (width - 1) / 2, (height - 1) / 2)
    return DepthCamera(name, width, height, np.eye(4), k)


def walls(camera, nearest_m=1.5):
    """Depth of a corner and a floor, shape (height, width) [m]."""
    x = np.linspace(-1, 1, camera.width)[None, :]
    y = np.linspace(-1, 1, camera.height)[:, None]
    return nearest_m * (1 + np.abs(x) + 0.3 * y)


class Sensor:
    """Gives an image with noise of its own each time."""

    def __init__(self, camera, nearest_m=1.5, seed=0):
        self.camera, self.random = camera, np.random.default_rng(seed)
        self.room_m = walls(camera, nearest_m)

    def image(self):
        return (self.room_m + self.random.normal(size=self.room_m.shape) * 0.005).astype(np.float32)


def moment(images, number, joints=None, **more):
    """A snapshot of images by camera, at the number-th step."""
    now_ns = T0_NS + number * STEP_NS
    frames = tuple(DepthFrame(name, now_ns, image) for name, image in images.items() if image is not None)
    return Snapshot(frames, joints, now_ns=now_ns, **more)
