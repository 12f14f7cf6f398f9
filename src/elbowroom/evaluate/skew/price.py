"""What aged claims cost: free voxels that are not found any more, of rooms that stand still."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import Detail
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.rooms.room import ROOM_LOWER_M, ROOM_UPPER_M
from elbowroom.evaluate.rooms.scene import WELL_KNOWN
from elbowroom.evaluate.skew.exposures import SPREADS_MS, ages_ms
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import SETUPS, InterventionRoom, Moment, render, setup, true_occupancy, wall_cameras

CAMERAS = 21
ROOM_AT_S = 7.0
LAWS_M_S = (1.6, 2.0)
SETUP_SPREAD_MS = 67.0
NOW_NS = 10**10
PRICE = where(room="simulated room", spread_ms=67.0, law_m_s=1.6, detail="pixel", voxel_size_m=0.02)
DUE = (
    Due("price_points", "≤", 1.5, PRICE, "points of found lost at 67 ms and 1.6 m/s in the simulated room"),
)


class _Room(NamedTuple):
    """A room that stands still: images of now, and its free voxels whose centre an exact camera sees."""

    name: str
    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    frames: list[DepthFrame]
    visible: NDArray[np.bool_]


def price_rows(
    voxel_size_m: float = 0.02,
    setups: Sequence[int] = (),
    draws: int = 3,
    seed: int = 1,
    spreads_ms: Sequence[float] = SPREADS_MS[1:],
) -> Iterator[dict[str, object]]:
    """The simulated room by spread, and setups at 67 ms: found without ages and with them, rule `three`.

    Args:
        voxel_size_m: edge of a voxel [m].
        setups: numbers of setups.
        draws: so often ages are dealt out anew; rows have the mean.
        seed: of the first.
        spreads_ms: of ages in the simulated room [ms].

    Yields:
        Rows of room, voxel_size_m, law_m_s, spread_ms, detail, found_pct, price_points.
    """
    room = InterventionRoom()
    at = room.at(ROOM_AT_S)
    simulated = _room("simulated room", at, voxel_size_m, (2.4,))
    for detail in ("pixel", "footprint"):
        yield from _prices(simulated, detail, spreads_ms, draws, seed)
    for each in SETUPS:
        if each.number in setups:
            moment = setup(each.number).at(room.machine)
            standing = _room(each.name, moment, voxel_size_m, (2.4, 0.4))
            yield from _prices(standing, "pixel", [SETUP_SPREAD_MS], draws, seed)


def _room(name: str, moment: Moment, voxel_size_m: float, heights_m: Sequence[float]) -> _Room:
    cameras = wall_cameras(CAMERAS, heights_m)
    grid = VoxelGrid.covering(ROOM_LOWER_M, ROOM_UPPER_M, voxel_size_m)
    frames, truth = render(cameras, moment, noise=False), true_occupancy(grid, moment)
    seen = reconstruct(grid, cameras, frames, rule="any", detail="point", looks=False).free
    visible = seen & ~truth.occupied & ~truth.machine
    visible[:, :, 0] = False
    return _Room(name, grid, cameras, frames, visible)


def _prices(
    room: _Room, detail: Detail, spreads_ms: Sequence[float], draws: int, seed: int
) -> Iterator[dict[str, object]]:
    before = _found_pct(room, detail, np.zeros(CAMERAS), LAWS_M_S[0])
    for law_m_s in LAWS_M_S:
        for spread_ms in spreads_ms:
            found = [
                _found_pct(room, detail, ages_ms(CAMERAS, spread_ms, seed + draw), law_m_s)
                for draw in range(draws)
            ]
            yield {
                "room": room.name,
                "voxel_size_m": room.grid.voxel_size_m,
                "detail": detail,
                "law_m_s": law_m_s,
                "spread_ms": spread_ms,
                "draws": draws,
                "found_without_pct": before,
                "found_pct": float(np.mean(found)),
                "price_points": before - float(np.mean(found)),
                "price_worst_points": before - min(found),
            }


def _found_pct(room: _Room, detail: Detail, ages: NDArray[np.float64], law_m_s: float) -> float:
    """Of the visible free voxels those that are declared free [%]."""
    frames = [
        DepthFrame(frame.camera, NOW_NS - round(age * 1e6), frame.depth_m)
        for frame, age in zip(room.frames, ages, strict=True)
    ]
    space = reconstruct(
        room.grid,
        room.cameras,
        frames,
        detail=detail,
        margin=WELL_KNOWN,
        now_ns=NOW_NS,
        people_speed_m_s=law_m_s,
        looks=False,
    )
    return 100 * float(space.free[room.visible].mean())


def prices(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Of each row of `price_rows` one of kind "price"."""
    return [{**row, "kind": "price"} for row in rows if "price_points" in row]
