"""Reconstruction accuracy (thesis 5.1.1, Tables 1 and 2): each voxel of each setup beside the truth.

An object voxel is one that a solid *touches*: its open box meets the solid. Besides, the milder measure: its *centre*
lies in a solid. Free voxels are all others that the machine does not touch. *found* is a share of those whose
centre some camera of the sensor sees, without the layer that touches the floor.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from elbowroom.choices import Detail
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.rooms.scene import room_grid
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis.due import DueLine
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.evaluate.thesis.reconstruction_blocks import reconstruction_blocks
from elbowroom.evaluate.thesis.setup_voxels import Images, SetupVoxels
from elbowroom.evaluate.thesis.thesis import c_arm, sensor_cameras
from elbowroom.sensing import Margin
from elbowroom.simulate import render, setup
from elbowroom.view.report.blocks import Block, cm, mean, pct

DETAILS: tuple[Detail, ...] = ("point", "footprint", "pixel")
VOXEL_SIZES_M = (0.10, 0.05, 0.02)
LATERAL_PX = (0.0, 0.25, 0.5, 1.0, 1.5)
"""Widths by which the thesis' sensor trades found space for kept objects."""
DRAWN_VOXEL_M = 0.05
KEPT_BY_TRADE_PCT = 98.5
"""Due of what the thesis' sensor keeps occupied at some width."""


def tasks(settings: Settings) -> list[Task]:
    """One for each setup and sensor."""
    return [
        Task(
            "reconstruction",
            f"setup{number}-{sensor}",
            judge_setup,
            {
                "number": number,
                "sensor": sensor,
                "voxel_sizes_m": list(settings.voxel_sizes_m or VOXEL_SIZES_M),
                "cameras": settings.cameras,
                "pictures": settings.pictures,
            },
        )
        for sensor in settings.sensors
        for number in settings.setups
    ]


def judge_setup(
    number: int, sensor: str, voxel_sizes_m: Sequence[float], cameras: int, pictures: bool
) -> Outcome:
    """All voxel sizes and details of one setup and sensor, without noise and with it.

    Args:
        number: of the setup.
        sensor: a name of `SENSORS`.
        voxel_sizes_m: edges of voxels [m].
        cameras: how many.
        pictures: whether to draw.
    """
    moment = setup(number).at(c_arm())
    rows: list[dict[str, Any]] = []
    drawn: dict[str, bytes] = {}
    plain, rough = (sensor_cameras(sensor, noise=noise, count=cameras) for noise in (False, True))
    exact = Images(plain, render(plain, moment, noise=False), False)
    noisy = Images(rough, render(rough, moment, seed=number), True)
    for edge in voxel_sizes_m:
        voxels = SetupVoxels(number, moment, room_grid(edge), exact)
        spaces = {}
        for images in (exact, noisy):
            for detail in DETAILS:
                space = voxels.space(images, detail, Margin())
                rows.append(voxels.row(space, images, detail, Margin()))
                if not images.noise:
                    spaces[detail] = space
        if sensor == "64x48" and abs(edge - 0.05) < 1e-9:
            rows += _trades(voxels, exact)
        if pictures and abs(edge - DRAWN_VOXEL_M) < 1e-9:
            drawn |= voxels.pictures(sensor, spaces)
    return Outcome(rows, drawn)


def _trades(voxels: SetupVoxels, exact: Images) -> list[dict[str, Any]]:
    """What widths of the pixels trade."""
    rows = []
    for margin in (Margin(lateral_px=lateral) for lateral in LATERAL_PX):
        space = voxels.space(exact, "pixel", margin)
        rows.append({**voxels.row(space, exact, "pixel", margin), "kind": "trade"})
    return rows


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The mean over the setups of each sensor, noise, voxel size and detail, and the least occupied share."""
    result = []
    shares = ("free_pct", "found_pct", "occupied_pct", "occupied_centre_pct", "free_centre_pct")
    same = ("sensor", "noise", "voxel_size_m", "rule", "detail", "cameras", "lateral_px")
    groups = dict.fromkeys((row["kind"], *(row[key] for key in same)) for row in rows)
    for kind, *values in groups:
        of_group = [r for r in rows if r["kind"] == kind and [r[key] for key in same] == values]
        result.append(
            {
                "kind": "summary",
                "of": kind,
                "setups": [row["setup"] for row in of_group],
                **dict(zip(same, values, strict=True)),
                **{key: mean([row[key] for row in of_group if row[key] is not None]) for key in shares},
                "least_occupied_pct": min(row["occupied_pct"] for row in of_group),
            }
        )
    return result


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Tables beside the thesis' Table 2, the trade of its sensor, pictures of the four cases."""
    return [about(__doc__), *reconstruction_blocks(rows, pictures)]


def _best_trade(rows: Sequence[Row], due: Due) -> Row:
    """Of the widths that keep enough occupied, or else of all, the one that finds the most."""
    kept = [row for row in rows if row["occupied_pct"] >= KEPT_BY_TRADE_PCT]
    return max(kept or rows, key=lambda row: float(row["found_pct"]))


def _widened(row: Row) -> str:
    return f"pixels widened by {row['lateral_px']:g} px"


def _free(row: Row) -> str:
    return f"{pct(row['free_pct'])} of all"


_VGA = {"sensor": "640x480", "noise": False}
_MEAN = {"kind": "summary", "of": "reconstruction", "detail": "pixel"}
_NOISY = where(**_MEAN, sensor="640x480", noise=True, voxel_size_m=0.02)
_TRADES = where(kind="summary", of="trade")
DUE = (
    *(
        DueLine(
            "occupied_pct",
            "≥",
            least,
            of=where(kind="reconstruction", **_VGA, voxel_size_m=edge, detail=detail),
            name=f"occupied, 640x480, {cm(edge)}, {detail}, worst setup [%]",
            thesis="91.1",
            digits=4,
        )
        for edge in (0.05, 0.02)
        for detail, least in (("footprint", 100.0), ("pixel", 99.99))
    ),
    *(
        DueLine(
            "found_pct",
            "≥",
            least,
            of=where(**_MEAN, **_VGA, voxel_size_m=edge),
            name=f"found of what is seen, 640x480, {cm(edge)}, pixel, mean [%]",
            thesis="98.9 of all",
            beside=_free,
        )
        for edge, least in ((0.02, 98.0), (0.05, 95.0))
    ),
    DueLine(
        "occupied_pct",
        "≥",
        KEPT_BY_TRADE_PCT,
        of=_TRADES,
        name="64x48, 5 cm, pixel: occupied [%]",
        thesis="91.1",
        pick=_best_trade,
        beside=_widened,
    ),
    DueLine(
        "found_pct",
        "≥",
        90.0,
        of=_TRADES,
        name="and found of what is seen [%]",
        thesis="98.9 of all",
        pick=_best_trade,
        beside=_widened,
    ),
    DueLine(
        "occupied_pct",
        "≥",
        99.99,
        of=_NOISY,
        name="with sensor noise, 640x480, 2 cm, pixel: occupied [%]",
        digits=4,
    ),
    DueLine("found_pct", "≥", 92.0, of=_NOISY, name="and found of what is seen [%]"),
)
PART = Part("reconstruction", "Reconstruction accuracy", tasks, summary, show, DUE)
