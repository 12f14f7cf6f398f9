"""Compiles the kernels of the watch before the machine is enabled."""

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.machine.probe import probe
from elbowroom.monitor.health.drift.link_spots import LinkSpots
from elbowroom.monitor.health.drift.reference import CameraReference, lens_of
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.sensing import DepthFrame, Snapshot


def warm_up_watch() -> None:
    """Runs every kernel of the watch once, on one camera before a wall."""
    camera = DepthCamera("one", 32, 24, np.eye(4), Intrinsics(30, 30, 15.5, 11.5))
    pixel = np.arange(0, camera.width * camera.height, 3)
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    ray = np.column_stack([x[pixel % camera.width], y[pixel // camera.width]])
    wall = CameraReference(
        camera="one",
        width=32,
        height=24,
        lens=lens_of(camera),
        radial=False,
        pixel=pixel,
        depth_m=np.full(len(pixel), 2.0),
        sigma_m=np.zeros(len(pixel)),
        ray=ray,
        normal=np.tile((0.0, 0.0, -1.0), (len(pixel), 1)),
    )
    watch = Watch([camera], [wall], probe())
    for stamp in range(2):
        depth = np.full((24, 32), 2.0, dtype=np.float32)
        watch.hear(Snapshot((DepthFrame("one", stamp, depth),), {"slide": 0.0}, now_ns=stamp))
    of_a_link = LinkSpots({"one": np.arange(2)}, np.ones((2, 3)), np.ones((2, 6)), np.ones(2), np.ones(2))
    of_a_link.health("base")
