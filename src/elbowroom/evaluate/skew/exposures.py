"""Images of things that move, each camera at a time of its own; and what was declared free of where they are now."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import DETAILS, RULES, Detail
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.carve import carve_aged
from elbowroom.reconstruct.resolve import resolve
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, Solid, render, true_occupancy
from elbowroom.simulate.furniture import shell

SPREADS_MS = (0.0, 17.0, 33.0, 67.0, 100.0, 133.0)
"""Between the newest image and the oldest one: none; half a frame of 30 Hz, one, two, three, four."""
LAWS_M_S = (0.0, 1.6, 2.0, 5.5)
"""How fast people are taken to be; 0: claims are not aged; 5.5: as fast as the feet of who walks at 1.6."""
DETAILS_ASKED: tuple[Detail, ...] = tuple(detail for detail in DETAILS if detail != "point")
NOW_S = 10.0
"""When everything is where it is asked for [s]."""
MARGIN = Margin()
"""What a site has that says nothing of it: half a pixel to each side, and no further error."""
LATERALS_PX = (0.0, 0.25, 0.5)
"""Margins to the side that are compared where nothing is aged [px]."""


@dataclass(frozen=True, slots=True)
class Scene:
    """Things that move in an empty room.

    Args:
        what: they are.
        grid: in which it is asked.
        at: the things at a time [s].
        speed_m_s: how fast they go as a whole [m/s].
    """

    what: str
    grid: VoxelGrid
    at: Callable[[float], tuple[Solid, ...]]
    speed_m_s: float

    @property
    def fastest_m_s(self) -> float:
        """The greatest speed of any of their points over 10 ms about now [m/s], hands and feet as well."""
        step, fastest = 1e-2, 0.0
        for time_s in np.arange(NOW_S - 0.14, NOW_S, 0.01):
            for one, other in zip(self.at(time_s), self.at(time_s + step), strict=True):
                moved = np.linalg.norm(_points(other) - _points(one), axis=1).max()
                fastest = max(fastest, float(moved) / step)
        return fastest


def _points(solid: Solid) -> NDArray[np.float64]:
    pose = solid.world_from_solid
    return solid.mesh.vertices @ pose[:3, :3].T + pose[:3, 3]


def ages_ms(cameras: int, spread_ms: float, seed: int) -> NDArray[np.float64]:
    """An age for each camera, evenly spread from 0, dealt out at random [ms].

    Args:
        cameras: how many.
        spread_ms: the greatest [ms].
        seed: of the deal.
    """
    return np.random.default_rng(seed).permutation(cameras) / max(1, cameras - 1) * spread_ms


def exposed(
    scene: Scene, cameras: Sequence[DepthCamera], ages: NDArray[np.float64], noise: bool
) -> list[DepthFrame]:
    """The image of each camera, of the room as it was that long ago.

    Args:
        scene: what moves.
        cameras: of the room.
        ages: of each camera's image [ms].
        noise: whether the sensors scatter.
    """
    frames = []
    for camera, age in zip(cameras, ages, strict=True):
        then = NOW_S - age / 1e3
        frames += render([camera], Moment(then, (*shell(), *scene.at(then)), {}), noise=noise)
    return frames


def falsely_free(
    scene: Scene, cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame], ages: NDArray[np.float64]
) -> Iterator[dict[str, object]]:
    """By law, detail and rule: of the voxels that the things touch now, how many are declared free.

    Args:
        scene: what moves.
        cameras, frames, ages: of `exposed`.
    """
    now = touched(scene)
    for law_m_s in LAWS_M_S:
        far = {c.name: law_m_s * age / 1e3 for c, age in zip(cameras, ages, strict=True)}
        for detail in DETAILS_ASKED:
            evidence = carve_aged(
                scene.grid, cameras, frames, far, detail=detail, margin=MARGIN, complete=True
            )
            for rule in RULES:
                free = resolve(evidence, cameras, rule=rule, detail=detail, margin=MARGIN).free
                yield {
                    "law_m_s": law_m_s,
                    "detail": detail,
                    "rule": rule,
                    "touched": int(now.sum()),
                    "false_free_voxels": int((free & now).sum()),
                }


def free_between_rays(
    scene: Scene, cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame]
) -> Iterator[dict[str, object]]:
    """By margin to the side, for detail `pixel` and rule `three`: of the voxels that are touched, how many are free.

    Args:
        scene: what moves.
        cameras: of the room, without noise.
        frames: of `exposed`, of no age.
    """
    now, none = touched(scene), {camera.name: 0.0 for camera in cameras}
    for lateral_px in LATERALS_PX:
        margin = Margin(lateral_px=lateral_px)
        evidence = carve_aged(scene.grid, cameras, frames, none, detail="pixel", margin=margin)
        free = resolve(evidence, cameras, detail="pixel", margin=margin).free
        yield {
            "lateral_px": lateral_px,
            "touched": int(now.sum()),
            "false_free_voxels": int((free & now).sum()),
        }


def touched(scene: Scene) -> NDArray[np.bool_]:
    """The voxels that the things touch now, shape of the grid.

    Args:
        scene: what moves.
    """
    return true_occupancy(scene.grid, Moment(NOW_S, scene.at(NOW_S), {})).occupied
