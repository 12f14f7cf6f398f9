"""Random sites of the simulator, as they should be: rooms, furniture, people, sensors and places drawn at random."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.evaluate.looks.scene import Scene, as_codes
from elbowroom.geometry import DepthCamera, VoxelGrid, looking_at
from elbowroom.sensing import NOISE_PRESETS, NoiseModel
from elbowroom.simulate import InterventionRoom, Moment, Optics, Solid, render
from elbowroom.simulate.inside import check_outside
from elbowroom.simulate.person import Person, Stance, Walk
from elbowroom.simulate.shapes import box, join

SIZES = ((64, 48), (96, 72), (160, 120), (224, 171), (320, 240), (160, 144))
UNITS_M = (0.001, 0.001, 0.0002, 0.00025)
FURTHEST_M = (np.inf, np.inf, 12.0, 10.0)
CAMERAS = (3, 21)
THICK_M = 0.2
TOP_DOWN, ALONG_AXES = 0.15, 0.1
"""Share of sites whose cameras all look straight down, and of those that look along the room's axes: equal depths."""
BEFORE_M = 0.5
"""Half of what a camera sees is farther than this [m]."""
OWN_ROOM = 0.3
"""Share of sites in the simulated intervention room."""


def random_site(number: int) -> Scene:
    """A site by its number: the same number is the same site.

    Args:
        number: 0 or more; seeds all that is drawn.
    """
    rng = np.random.default_rng([number, 1407])
    size, solids = _room(rng)
    grid = _grid(rng, size)
    cameras = _cameras(rng, size, solids)
    moment = Moment(float(number), solids, {})
    unit_m = float(rng.choice(UNITS_M))
    images = {frame.camera: frame.depth_m for frame in render(cameras, moment, seed=number)}
    # nobody hangs a camera behind a cabinet
    free = [c for c in cameras if np.median(images[c.name]) > BEFORE_M] or list(cameras)
    return Scene(
        f"random {number}",
        grid,
        free,
        {camera.name: as_codes(images[camera.name], unit_m) for camera in free},
        dict.fromkeys((camera.name for camera in free), unit_m),
    )


def _room(rng: np.random.Generator) -> tuple[NDArray[np.float64], tuple[Solid, ...]]:
    """Its inner size [m], about x = y = 0 from the floor up, and all that is in it."""
    if rng.random() < OWN_ROOM:
        moment = InterventionRoom(people=bool(rng.random() < 0.7)).at(float(rng.uniform(0, 600)))
        return np.array([4.1, 4.1, 2.9]), moment.solids
    size = np.array([rng.uniform(2.5, 8.0), rng.uniform(2.5, 8.0), rng.uniform(2.3, 4.0)])
    return size, (*_shell(size), *_furniture(rng, size), *_people(rng, size))


def _solid(name: str, lower: NDArray[np.float64], upper: NDArray[np.float64]) -> Solid:
    return Solid(name, join([box(lower, upper)]), np.eye(4), is_static=True)


def _shell(size: NDArray[np.float64]) -> tuple[Solid, ...]:
    inner = np.array([-size[0] / 2, -size[1] / 2, 0.0]), np.array([size[0] / 2, size[1] / 2, size[2]])
    lower, upper = inner[0] - THICK_M, inner[1] + THICK_M
    slabs = []
    for axis in range(3):
        low, high = upper.copy(), lower.copy()
        low[axis], high[axis] = inner[0][axis], inner[1][axis]
        slabs += [_solid(f"wall {axis}-", lower, low), _solid(f"wall {axis}+", high, upper)]
    return tuple(slabs)


def _furniture(rng: np.random.Generator, size: NDArray[np.float64]) -> tuple[Solid, ...]:
    boxes = []
    for number in range(int(rng.integers(0, 8))):
        extent = rng.uniform((0.2, 0.2, 0.3), (1.2, 1.2, 1.6))
        middle = rng.uniform(-0.4, 0.4, 2) * (size[:2] - extent[:2])
        foot = float(rng.choice((0.0, 0.0, 0.7)))
        lower = np.array([*(middle - extent[:2] / 2), foot])
        boxes.append(
            _solid(f"box {number}", lower, np.minimum(lower + extent, (np.inf, np.inf, size[2] - 0.1)))
        )
    return tuple(boxes)


def _people(rng: np.random.Generator, size: NDArray[np.float64]) -> tuple[Solid, ...]:
    solids: list[Solid] = []
    for number in range(int(rng.integers(0, 4))):
        x, y = rng.uniform(-0.35, 0.35, 2) * size[:2]
        person = Person(
            f"person {number}", Walk((0.0, 0.0), (0.1, 0.1), 10.0), float(rng.uniform(1.55, 1.95))
        )
        solids += person.solids(
            Stance(float(x), float(y), float(rng.uniform(0, 6.28)), float(rng.uniform(0, 6.28)))
        )
    return tuple(solids)


def _grid(rng: np.random.Generator, size: NDArray[np.float64]) -> VoxelGrid:
    """Most of the room, or a part of it; its floor is the room's, or lies a little above."""
    inset = rng.uniform(0.0, 0.25, 2) * size[:2]
    lower = np.array([*(-size[:2] / 2 + inset), float(rng.choice((0.0, 0.0, 0.05, 0.1)))])
    upper = np.array([*(size[:2] / 2 - inset[::-1] * 0.8), float(rng.uniform(1.9, size[2]))])
    return VoxelGrid.covering(lower, upper, float(rng.choice((0.05, 0.1))))


def _cameras(
    rng: np.random.Generator, size: NDArray[np.float64], solids: tuple[Solid, ...]
) -> tuple[DepthCamera, ...]:
    """Near walls and ceiling, outside all that is solid, looking into the room."""
    width, height = SIZES[int(rng.integers(len(SIZES)))]
    optics = Optics(
        float(rng.uniform(55, 110)),
        "radial" if rng.random() < 0.2 else "planar",
        0.1,
        float(rng.choice(FURTHEST_M)),
    )
    like = DepthCamera(
        "like",
        width,
        height,
        np.eye(4),
        optics.intrinsics(width, height),
        optics.depth_kind or "planar",
        _noise(rng),
        min_depth_m=optics.min_depth_m,
        max_depth_m=optics.max_depth_m,
    )
    how = rng.random()
    cameras: list[DepthCamera] = []
    count = int(rng.integers(CAMERAS[0], CAMERAS[1] + 1))
    while len(cameras) < count:
        camera = replace(like, name=f"cam{len(cameras):02d}", world_from_camera=_pose(rng, size, float(how)))
        try:
            check_outside([camera], solids)
        except InputError:
            continue
        cameras.append(camera)
    return tuple(cameras)


def _noise(rng: np.random.Generator) -> NoiseModel | None:
    return None if rng.random() < 0.3 else NOISE_PRESETS[str(rng.choice(sorted(NOISE_PRESETS)))]


def _pose(rng: np.random.Generator, size: NDArray[np.float64], how: float) -> NDArray[np.float64]:
    half = size[:2] / 2 - 0.06
    if how < TOP_DOWN:
        x, y = rng.uniform(-0.7, 0.7, 2) * half
        return looking_at((float(x), float(y), float(size[2] - 0.1)), (float(x), float(y), 0.0))
    side = int(rng.integers(4))
    along = float(rng.uniform(-0.9, 0.9))
    x, y = (
        (half[0], along * half[1]),
        (-half[0], along * half[1]),
        (along * half[0], half[1]),
        (along * half[0], -half[1]),
    )[side]
    z = float(rng.uniform(0.4, size[2] - 0.1))
    if how < TOP_DOWN + ALONG_AXES:
        at = (-x, y, z) if side < 2 else (x, -y, z)
        return looking_at((float(x), float(y), z), tuple(float(v) for v in at))
    aim = rng.uniform(-0.3, 0.3, 2) * size[:2]
    return looking_at((float(x), float(y), z), (float(aim[0]), float(aim[1]), float(rng.uniform(0.4, 1.4))))
