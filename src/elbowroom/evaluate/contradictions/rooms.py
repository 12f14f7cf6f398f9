"""Random rooms with random cameras: what a site may be."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, looking_at
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.geometry.twist import exp
from elbowroom.sensing import NOISE_PRESETS, Snapshot
from elbowroom.simulate import InterventionRoom, Moment, Optics, Solid, Walls, render, wall_cameras
from elbowroom.simulate.inside import solid_about
from elbowroom.simulate.shapes import box, join

FEWEST, MOST = 3, 21
"""Cameras of a site."""
SIZES = ((160, 120), (128, 96), (64, 48), (160, 144), (213, 120))
"""Of images [px]."""
TURNED_RAD, MOVED_M = 0.005, 0.008
"""What calibration of the usual size leaves open: a turn about a random axis and a move, standard deviations."""
SKEW_S = 0.03
"""Exposures of one moment lie up to so far apart in every second site."""
MARGIN = Margin(bias_m=0.01)
"""What the sites declare."""
THEATRE_M = (2.0, 2.0, 2.9)
"""Half sides and height of the simulated intervention room [m]."""
VOXEL_SIZE_M = 0.05

Rng = np.random.Generator
MomentAt = Callable[[float], Moment]


@dataclass(frozen=True, slots=True, eq=False)
class RandomSite:
    """Cameras, as they are described, and what they saw.

    Args:
        number: of the site; all of it follows from that.
        cameras: as they are said to be: right, but for what a calibration leaves open.
        snapshot: one frame of each.
        grid: the watched box.
        noise: name of the sensors' noise.
        room: what kind of.
    """

    number: int
    cameras: tuple[DepthCamera, ...]
    snapshot: Snapshot
    grid: VoxelGrid
    noise: str
    room: str

    @property
    def names(self) -> tuple[str, ...]:
        """Of the cameras."""
        return tuple(camera.name for camera in self.cameras)


def random_site(number: int) -> RandomSite:
    """A site of 3 to 21 cameras: the intervention room, or a hall with crates in it.

    Args:
        number: 0 or more.
    """
    rng = np.random.default_rng([20, number])
    noise = str(rng.choice(["exact", *NOISE_PRESETS]))
    is_theatre = bool(rng.random() < 0.5)
    size = np.array(THEATRE_M) if is_theatre else rng.uniform((1.6, 1.6, 2.4), (4.0, 4.0, 4.5))
    cameras = _cameras(rng, NOISE_PRESETS.get(noise), size)
    moment_at = _theatre(rng) if is_theatre else _hall(rng, size)
    solids = moment_at(0.0).solids
    # nobody hangs a camera into a cabinet
    cameras = tuple(camera for camera in cameras if solid_about(camera.centre_in_world, solids) is None)
    skew_s = SKEW_S if rng.random() < 0.5 else 0.0
    frames = [
        frame
        for camera in cameras
        for frame in render([camera], moment_at(float(rng.uniform(0.0, skew_s))), seed=number)
    ]
    newest_ns = max(frame.stamp_ns or 0 for frame in frames)
    return RandomSite(
        number,
        tuple(_as_calibrated(rng, camera) for camera in cameras),
        Snapshot.taken(frames, None, newest_ns),
        VoxelGrid.covering((-size[0], -size[1], 0.0), size - (0.0, 0.0, 0.1), VOXEL_SIZE_M),
        noise,
        "theatre" if is_theatre else "hall",
    )


def _cameras(rng: Rng, noise: NoiseModel | None, size: NDArray[np.float64]) -> tuple[DepthCamera, ...]:
    """Along the walls, all alike and looking at the middle, or each somewhere else."""
    width, height = SIZES[int(rng.integers(len(SIZES)))]
    optics = Optics(
        float(rng.uniform(60.0, 100.0)),
        "radial" if rng.random() < 0.3 else "planar",
        0.1,
        float(rng.choice((np.inf, 10.0, 6.0))),
    )
    aim_m = float(rng.uniform(0.7, 1.4))
    made = wall_cameras(
        int(rng.integers(FEWEST, MOST + 1)),
        tuple(rng.uniform(0.75, 0.95, size=int(rng.integers(1, 4))) * size[2]),
        width,
        height,
        optics=optics,
        walls=Walls((0.97 * size[0], 0.97 * size[1]), aim_m=aim_m),
        noise=noise,
    )
    if rng.random() < 0.5:
        return made
    return tuple(_elsewhere(rng, camera, size, aim_m) for camera in made)


def _elsewhere(rng: Rng, camera: DepthCamera, size: NDArray[np.float64], aim_m: float) -> DepthCamera:
    """The camera at another place near its own, rolled a little, looking somewhere about the middle."""
    eye = camera.centre_in_world * (*rng.uniform(0.8, 1.0, size=2), rng.uniform(0.85, 1.0))
    target = np.append(rng.uniform(-0.5, 0.5, size=2) * size[:2], aim_m * rng.uniform(0.3, 1.2))
    pose = looking_at(tuple(eye), tuple(target)) @ exp(np.array((0, 0, rng.normal(0, 0.1), 0, 0, 0)))
    return replace(camera, world_from_camera=pose)


def _as_calibrated(rng: Rng, camera: DepthCamera) -> DepthCamera:
    """The camera as its description has it: a little off."""
    off = np.concatenate([rng.normal(0, TURNED_RAD / 3**0.5, 3), rng.normal(0, MOVED_M / 3**0.5, 3)])
    return replace(camera, world_from_camera=camera.world_from_camera @ exp(off))


def _theatre(rng: Rng) -> MomentAt:
    """The intervention room at some time, with or without people."""
    room = InterventionRoom(people=bool(rng.random() < 0.8))
    begin_s = float(rng.uniform(0.0, 600.0))
    return lambda after_s: room.at(begin_s + after_s)


def _hall(rng: Rng, size: NDArray[np.float64]) -> MomentAt:
    """A room of any size with crates on its floor."""
    (a, b, c), t = size, 0.2
    parts = {
        "floor": [box((-a - t, -b - t, -t), (a + t, b + t, 0))],
        "ceiling": [box((-a - t, -b - t, c), (a + t, b + t, c + t))],
        "wall -x": [box((-a - t, -b - t, -t), (-a, b + t, c + t))],
        "wall +x": [box((a, -b - t, -t), (a + t, b + t, c + t))],
        "wall -y": [box((-a - t, -b - t, -t), (a + t, -b, c + t))],
        "wall +y": [box((-a - t, b, -t), (a + t, b + t, c + t))],
    }
    for number in range(int(rng.integers(3, 10))):
        edge = rng.uniform((0.2, 0.2, 0.3), (0.9, 0.9, 1.8))
        place = rng.uniform(-0.6, 0.6, size=2) * size[:2]
        lower = np.array((*(place - edge[:2] / 2), 0.0))
        parts[f"crate {number}"] = [box(lower, lower + edge)]
    solids = tuple(Solid(name, join(shapes), np.eye(4), is_static=True) for name, shapes in parts.items())
    return lambda after_s: Moment(1.0 + after_s, solids, {})
