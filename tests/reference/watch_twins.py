"""The watch's kernels as plain NumPy, and rooms of six walls whose depth is known by a formula."""

import numpy as np
from scipy.spatial.transform import Rotation

from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.kernels import watch as kernels
from elbowroom.sensing import DepthFrame, Snapshot

LOWER, UPPER = np.array((-2.0, -2.2, 0.0)), np.array((2.3, 2.0, 2.8))


def listen(image, spots, least, greatest, gate, before):
    """What one frame makes of the means before: (offset, sigma, frames) by spot, the spots used, the four numbers."""
    after, used, numbers = [], [], [0, 0, 0, 0]
    for i, place in enumerate(spots.pixel):
        depth, sigma = float(image[place]), spots.sigma[i]
        offset = (depth - spots.depth[i]) * spots.scale[i]
        mean, _, frames = before[i]
        if not np.isfinite(depth) or depth <= 0 or not least <= depth <= greatest:
            numbers[3] += 1
            after.append(None)
        elif abs(offset) > gate + 4 * sigma:
            numbers[1 if offset < 0 else 2] += 1
            after.append(None)
        else:
            steps = frames == 0 or abs(offset - mean) > kernels.STEP_M + kernels.STEP_SIGMAS * sigma
            frames = 1 if steps else min(frames + 1, kernels.MEAN_OF)
            mean = offset if steps else mean + (offset - mean) / frames
            after.append((mean, max(sigma / np.sqrt(frames), kernels.LEAST_SIGMA_M), frames))
            used.append(i)
            numbers[0] += 1
    return after, used, numbers


def fit_motion(jacobian, offset, sigma, turn_sigma, move_sigma):
    """Motion, covariance, and what is said for it, by matrices."""
    motion = np.zeros(6)
    prior = np.diag([turn_sigma**-2.0] * 3 + [move_sigma**-2.0] * 3)
    widths = np.geomspace(kernels.WIDEST_M, kernels.NARROWEST_M, kernels.STEPS)
    for width in widths:
        left = offset - jacobian @ motion
        weight = (1 + (left / (width + kernels.SIGMAS * sigma)) ** 2) ** -2.0 / sigma**2
        information = jacobian.T @ (weight[:, None] * jacobian) + prior
        motion = np.linalg.solve(information, jacobian.T @ (weight * offset))

    def likelihood(left):
        return np.log(kernels.STRAY + (1 - kernels.STRAY) * np.exp(-0.5 * (left / sigma) ** 2))

    left = offset - jacobian @ motion
    gain = likelihood(left) - likelihood(offset)
    near = kernels.FITS_M + kernels.FITS_SIGMAS * sigma
    said = [
        gain[gain > 0].sum(),
        -gain[gain <= 0].sum(),
        np.mean(np.abs(offset) <= near),
        np.mean(np.abs(left) <= near),
    ]
    return motion, np.linalg.inv(information), said


def camera_at(name="north", eye=(-1.9, 0.2, 2.3), target=(0.6, -0.2, 0.6), size=(80, 60), **more):
    """A camera of 90 degrees in the room of six walls."""
    width, height = size
    intrinsics = Intrinsics(width / 2, width / 2, (width - 1) / 2, (height - 1) / 2)
    return DepthCamera(name, width, height, looking_at(eye, target), intrinsics, max_depth_m=9.0, **more)


def knocked(camera, turn_deg=(0, 0, 0), move_m=(0, 0, 0)):
    """The same camera elsewhere, by a turn and a move in its own axes."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(np.radians(turn_deg)).as_matrix()
    pose[:3, 3] = move_m
    return DepthCamera(
        camera.name, camera.width, camera.height, camera.world_from_camera @ pose, camera.intrinsics,
        depth_kind=camera.depth_kind, max_depth_m=camera.max_depth_m,
    )  # fmt: skip


def walls(camera):
    """Depth of the six walls, shape (height, width) [m, the camera's kind]."""
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    rays = np.stack([*np.meshgrid(x, y), np.ones((camera.height, camera.width))], axis=-1)
    directions, eye = rays @ camera.world_from_camera[:3, :3].T, camera.centre_in_world
    with np.errstate(divide="ignore"):
        away = np.where(directions > 0, (UPPER - eye) / directions, (LOWER - eye) / directions)
    depth = away.min(axis=-1)
    return depth * camera.radial_over_planar if camera.depth_kind == "radial" else depth


def frame(camera, stamp_ns=0, noise_m=0.0, rng=None, depth=None):
    """A frame of the six walls, or of a given image, with noise."""
    image = walls(camera) if depth is None else depth
    if noise_m:
        image = image + (rng or np.random.default_rng(stamp_ns % 1000)).normal(0, noise_m, image.shape)
    return DepthFrame(camera.name, stamp_ns, np.float32(image))


NOISE_M = 0.005
CAMERAS = (
    camera_at("north", (-1.9, 0.2, 2.3), (0.6, -0.2, 0.6)),
    camera_at("east", (0.3, 1.8, 2.4), (0.0, -0.6, 0.5), depth_kind="radial"),
    camera_at("low", (2.1, -1.9, 0.4), (-0.5, 0.3, 1.2)),
)


def commissioned(cameras, noise_m=NOISE_M):
    """References of cameras in the empty room of six walls."""
    room = Commissioning(cameras, None, 10)
    for number in range(10):
        room.add(Snapshot.taken([frame(camera, number, noise_m) for camera in cameras]))
    return room.references()
