"""What the cameras of a case see, written for the case's own process."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.speed.balls import depth_of_balls, random_balls, ring_cameras
from elbowroom.evaluate.speed.questions import BALL_M, Asked
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, wall_cameras

MOMENTS_S = (3.0, 11.0)
"""Of people walking [s]."""
STILL_S = (3.0, 3.0)
"""Of a room in which nothing moves: the noise is another in each."""


def scene_of(asked: Asked) -> tuple[Any, ...]:
    """What of a case its images depend on."""
    seen = asked.scene, asked.noise, asked.cameras, asked.width, asked.height
    return (*seen, asked.half_m, asked.balls) if asked.scene == "balls" else seen


def save_scene(path: Path, asked: Asked) -> None:
    """Writes the images of a case, with poses, lens and the machine's joints.

    Args:
        path: of the file.
        asked: the case.
    """
    cameras, images, joints = _balls(asked) if asked.scene == "balls" else _room(asked)
    k = cameras[0].intrinsics
    np.savez(
        path,
        poses=np.array([camera.world_from_camera for camera in cameras]),
        lens=np.array([k.fx, k.fy, k.cx, k.cy]),
        depths=images,
        joints=joints,
    )


def _balls(asked: Asked) -> tuple[list[DepthCamera], NDArray[np.float32], NDArray[np.float64]]:
    cameras = list(ring_cameras(asked.cameras, asked.width, asked.height))
    # of the smallest grid: the balls lie in all of them
    balls = random_balls(asked.balls, BALL_M, min(asked.half_m, 0.5) if asked.balls == 1 else asked.half_m)
    return cameras, np.array([[depth_of_balls(camera, balls) for camera in cameras]]), np.zeros((1, 0))


def _room(asked: Asked) -> tuple[list[DepthCamera], NDArray[np.float32], NDArray[np.float64]]:
    room = InterventionRoom()
    noise = NOISE_PRESETS["tof"] if asked.noise else None
    cameras = list(wall_cameras(asked.cameras, width=asked.width, height=asked.height, noise=noise))
    moments = [room.at(time_s) for time_s in (STILL_S if asked.scene == "nothing moves" else MOMENTS_S)]
    joints = np.array([[moment.joints[name] for name in room.machine.joint_names] for moment in moments])
    if asked.scene == "every pixel changes":
        shape = len(moments), len(cameras), asked.height, asked.width
        images = np.random.default_rng(0).uniform(0.5, 5.0, shape).astype(np.float32)
        return cameras, images, joints
    seen = [[frame.depth_m for frame in render(cameras, moment, seed=n)] for n, moment in enumerate(moments)]
    return cameras, np.array(seen), joints
