"""Calibration error (thesis 6.1.2): cameras that are not quite where they are said to be.

Each camera's said pose is turned about its own three axes by angles drawn evenly from +-a, and moved along the world's
axes by lengths drawn evenly from +-b. The *declared margin* for errors up to a and b is three quarters of them: pixels
are widened by f a + f b / 2.5 m, and depth is trusted to b + a z. The curves look at a fixed third of the room.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.evaluate.rooms.room import Tally
from elbowroom.evaluate.rooms.scene import DECIMALS, room_grid
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis.part import Part
from elbowroom.evaluate.thesis.thesis import HEIGHTS_M, c_arm
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Truth, render, setup, true_occupancy, wall_cameras
from elbowroom.view.report.blocks import Block, Picture, Table, Words, cm, mean, pct
from elbowroom.view.report.charts import Line, chart

MARGIN = 0.75
"""The declared margin, as a share of the greatest error about each axis."""
NEAR_M = 2.5
"""A shift across the ray is as many pixels as it is at this depth [m]."""
VOXEL_M = 0.05
ROTATIONS_DEG = (1.0, 2.0, 3.0)
TRANSLATIONS_M = (0.01, 0.02, 0.05)
SHARES = (0.25, 0.5, 1.0, 1.5)
"""Margins besides 0 and the declared one whose effect is shown."""
THIRD = 3
CHUNK = 25
"""Draws of one share of the work."""
MEASURES = ("occupied_pct", "found_pct", "free_pct")


def tasks(settings: Settings) -> list[Task]:
    """Draws of the due case, of margins for it, of the curves, and of the thesis' own sensor and test."""
    one_degree, one_cm = 1.0, 0.01
    cases: list[dict[str, Any]] = [
        _case("due", "vga", one_degree, one_cm, (0.0, MARGIN), whole=True),
        _case("margins", "vga", one_degree, one_cm, SHARES),
        *(_case("rotation", "qqvga", a, 0.0, (0.0, MARGIN)) for a in (0.0, *ROTATIONS_DEG)),
        *(_case("translation", "qqvga", 0.0, b, (0.0, MARGIN)) for b in TRANSLATIONS_M),
        *(
            _case("thesis", "thesis", a, b, (0.0,), whole=True, detail="point")
            for a, b in ((0.0, 0.0), (one_degree, 0.0), (0.0, one_cm))
        ),
    ]
    edge = settings.voxel_sizes_m[0] if settings.voxel_sizes_m else VOXEL_M
    number = settings.setups[0]
    result = []
    for case in cases:
        exact = case["rotation_deg"] == case["translation_m"] == 0
        draws = 1 if exact else settings.draws
        for first in range(0, draws, CHUNK):
            words = (
                f"{case['curve']}-{case['rotation_deg']:g}deg-{case['translation_m'] * 1000:g}mm-{first:03d}"
            )
            result.append(
                Task(
                    "calibration",
                    words,
                    judge_draws,
                    {
                        **case,
                        "number": number,
                        "voxel_size_m": edge,
                        "first": first,
                        "draws": min(CHUNK, draws - first),
                        "cameras": settings.cameras,
                    },
                )
            )
    return result


def _case(
    curve: str,
    size: str,
    rotation_deg: float,
    translation_m: float,
    shares: Sequence[float],
    *,
    whole: bool = False,
    detail: str = "pixel",
) -> dict[str, Any]:
    return {
        "curve": curve,
        "size": size,
        "rotation_deg": rotation_deg,
        "translation_m": translation_m,
        "shares": list(shares),
        "whole": whole,
        "detail": detail,
    }


def judge_draws(
    curve: str,
    size: str,
    rotation_deg: float,
    translation_m: float,
    shares: Sequence[float],
    whole: bool,
    detail: Any,
    number: int,
    voxel_size_m: float,
    first: int,
    draws: int,
    cameras: int,
) -> Outcome:
    """Some draws of one size of error, with each margin."""
    machine, moment = c_arm(), setup(number).at(c_arm())
    grid, truth, views, frames, seen = _exact_scene(number, voxel_size_m, size, cameras)
    focus = None if whole else third_of(grid)
    looked_at = np.ones(grid.shape, dtype=np.bool_) if focus is None else _voxels_of(focus, grid)
    found: dict[float, list[dict[str, Any]]] = {share: [] for share in shares}
    for draw in range(first, first + draws):
        said = disturbed(views, rotation_deg, translation_m, np.random.default_rng([draw, 612]))
        for share in shares:
            margin = margin_for(rotation_deg, translation_m, share, views[0].intrinsics.fx)
            space = reconstruct(
                grid,
                said,
                frames,
                machine=machine,
                joints=moment.joints,
                detail=detail,
                margin=margin,
                focus=focus,
            )
            tally = Tally()
            tally.add(space.free, truth.occupied & looked_at, truth.machine | ~looked_at, seen & looked_at)
            found[share].append(tally.row())
    case = {
        "kind": "draws",
        "curve": curve,
        "setup": number,
        "sensor": f"{views[0].width}x{views[0].height}",
        "noise": False,
        "voxel_size_m": voxel_size_m,
        "rule": "three",
        "detail": detail,
        "rotation_deg": rotation_deg,
        "translation_m": translation_m,
        "first": first,
    }
    return Outcome([{**case, "margin_share": share, **_of_draws(found[share])} for share in shares])


@lru_cache(maxsize=2)
def _exact_scene(
    number: int, voxel_size_m: float, size: str, cameras: int
) -> tuple[VoxelGrid, Truth, tuple[DepthCamera, ...], list[DepthFrame], NDArray[np.bool_]]:
    """What all draws of a sensor share: grid, truth, cameras where they really are, images, voxels seen by them."""
    grid, moment = room_grid(voxel_size_m), setup(number).at(c_arm())
    views = wall_cameras(cameras, HEIGHTS_M, size=size)
    frames = render(views, moment, noise=False)
    seen = reconstruct(grid, views, frames, rule="any", detail="point").free
    return grid, true_occupancy(grid, moment), views, frames, seen


def _of_draws(tallies: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Means over some draws, and each draw's own figures in their order."""
    each = {key: [round(tally[key], DECIMALS) for tally in tallies] for key in MEASURES}
    return {**{key: mean(values) for key, values in each.items()}, "each": each}


def margin_for(rotation_deg: float, translation_m: float, share: float, focal_px: float) -> Margin:
    """The margin declared for errors of so much about each axis, or a share of it."""
    angle, length = share * np.radians(rotation_deg), share * translation_m
    return Margin(lateral_px=0.5 + focal_px * (angle + length / NEAR_M), bias_m=length, range_linear=angle)


def disturbed(
    cameras: Sequence[DepthCamera], rotation_deg: float, translation_m: float, rng: np.random.Generator
) -> tuple[DepthCamera, ...]:
    """The cameras as a calibration that is off would say them."""
    said = []
    for camera in cameras:
        pose = np.array(camera.world_from_camera)
        turn = Rotation.from_euler("xyz", rng.uniform(-rotation_deg, rotation_deg, 3), degrees=True)
        pose[:3, :3] = pose[:3, :3] @ turn.as_matrix()
        pose[:3, 3] += rng.uniform(-translation_m, translation_m, 3)
        said.append(replace(camera, world_from_camera=pose))
    return tuple(said)


def third_of(grid: VoxelGrid) -> NDArray[np.bool_]:
    """A fixed random third of the blocks of 4 voxels, for `reconstruct(focus=...)`."""
    return np.random.default_rng(1).random(bits.empty(grid).shape) < 1 / THIRD


def _voxels_of(focus: NDArray[np.bool_], grid: VoxelGrid) -> NDArray[np.bool_]:
    words = np.where(focus, np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(0)).astype(np.uint64)
    return bits.unpack(words & bits.inside(grid), grid)


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Mean and worst of the draws of each case and margin."""
    same = (
        "curve",
        "setup",
        "sensor",
        "voxel_size_m",
        "detail",
        "rotation_deg",
        "translation_m",
        "margin_share",
    )
    result = []
    for values in dict.fromkeys(tuple(row[key] for key in same) for row in rows):
        mine = [row for row in rows if tuple(row[key] for key in same) == values]
        each = {key: [value for row in mine for value in row["each"][key]] for key in MEASURES}
        result.append(
            {
                "kind": "summary",
                **dict(zip(same, values, strict=True)),
                "noise": False,
                "rule": "three",
                "draws": len(each["occupied_pct"]),
                **{key: mean(each[key]) for key in MEASURES},
                "least_occupied_pct": min(each["occupied_pct"]),
                "least_found_pct": min(each["found_pct"]),
            }
        )
    return result


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """The due case, the price of margins in one picture, curves over the error."""
    means = [row for row in rows if row["kind"] == "summary"]
    blocks: list[Block] = [Words(" ".join((__doc__ or "").split("\n\n", 1)[1].split()))]
    titles = {
        "due": "Errors up to 1 degree and 1 cm without margin and with the declared one (due 99.99, 75)",
        "margins": "The same with other margins, on a third of the room",
        "rotation": "Turned",
        "translation": "Moved",
        "thesis": "The thesis' sensor and point test, no margin: it says the accuracy does not change",
    }
    for curve, title in titles.items():
        mine = [row for row in means if row["curve"] == curve]
        if mine:
            blocks.append(_table(title, mine))
    price = sorted(
        (r for r in means if r["curve"] in ("due", "margins")), key=lambda r: float(r["margin_share"])
    )
    if len(price) > 2:
        points = [(r["margin_share"], r["occupied_pct"], r["found_pct"]) for r in price]
        lines = (
            Line("objects kept (occupied)", [(x, y) for x, y, _ in points]),
            Line("free space found", [(x, y) for x, _, y in points]),
        )
        words = (
            "What margin buys and costs: +-1 degree, +-1 cm, 640x480. Margin as a share of the greatest error"
        )
        blocks.append(Picture(chart(lines, "margin", "%"), words, 560))
    for curve, unit, scale in (("rotation", "degrees", 1.0), ("translation", "cm", 100.0)):
        mine = [row for row in means if row["curve"] in (curve, "rotation") and _of(row, curve)]
        if len(mine) > 2:
            blocks.append(
                Picture(
                    _curve(mine, f"{curve}_{'deg' if curve == 'rotation' else 'm'}", unit, scale),
                    f"{curve}: mean of the draws",
                    560,
                )
            )
    return blocks


def _of(row: Row, curve: str) -> bool:
    """Whether a row belongs to a curve: the exact case is the beginning of both."""
    return row["curve"] == curve or (row["rotation_deg"] == 0 and row["translation_m"] == 0)


def _curve(rows: Sequence[Row], key: str, unit: str, scale: float) -> bytes:
    lines = []
    for share, words in ((0.0, "no margin"), (MARGIN, "declared margin")):
        mine = sorted((r for r in rows if r["margin_share"] == share), key=lambda r: float(r[key]))
        for measure, of in (("occupied_pct", "occupied"), ("found_pct", "found")):
            lines.append(Line(f"{of}, {words}", [(r[key] * scale, r[measure]) for r in mine]))
    return chart(lines, f"greatest error about each axis [{unit}]", "%")


def _table(title: str, rows: Sequence[Row]) -> Table:
    return Table(
        title,
        ("sensor", "voxel", "detail", "turned", "moved", "margin", "draws", "occupied", "least", "found"),
        [
            (
                r["sensor"],
                cm(r["voxel_size_m"]),
                r["detail"],
                f"{r['rotation_deg']:g} deg",
                cm(r["translation_m"]),
                f"{r['margin_share']:g}",
                str(r["draws"]),
                pct(r["occupied_pct"], 3),
                pct(r["least_occupied_pct"], 3),
                pct(r["found_pct"]),
            )
            for r in rows
        ],
        left=(0, 2),
    )


PART = Part("calibration", "Calibration error", tasks, summary, show)
