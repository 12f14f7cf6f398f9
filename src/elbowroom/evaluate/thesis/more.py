"""What else the thesis claims: more sensors give more freedom (3.2), small objects are missed (6.1.1), its Fig. 3.

Small objects are balls hung at random in the bare room. One is *missed* if every voxel that it touches is declared
free; beside it the share of touched voxels that are. Free travel is that of all joints in both directions from the
setups' poses, as a share of the truth.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.room import Tally
from elbowroom.evaluate.rooms.scene import room_grid, room_motions
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.tables import table_of
from elbowroom.evaluate.thesis.fig3 import fig3_picture
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.evaluate.thesis.thesis import c_arm, sensor_cameras
from elbowroom.extras import package
from elbowroom.motion import check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.simulate import Moment, Solid, render, setup, true_occupancy
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.inside import hung_clear
from elbowroom.simulate.shapes import ellipsoid, join
from elbowroom.simulate.truth import touched_by
from elbowroom.view.report.blocks import Block, Picture, Table, cm, mean, pct
from elbowroom.view.report.charts import Line, chart

COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 21)
SIZES_M = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
BALLS = 60
VOXEL_M = 0.05


def tasks(settings: Settings) -> list[Task]:
    """Numbers of cameras in two setups, sizes of objects by sensor, and the figure.

    Raises:
        PackageError: coal is not installed.
    """
    package("coal")
    edge = settings.voxel_sizes_m[0] if settings.voxel_sizes_m else VOXEL_M
    result = [
        Task("more", f"cameras-setup{number}", judge_counts, {"number": number, "voxel_size_m": edge})
        for number in settings.setups[:2]
    ]
    result += [
        Task("more", f"balls-{sensor}", judge_balls, {"sensor": sensor, "voxel_size_m": edge})
        for sensor in settings.sensors
    ]
    if settings.pictures:
        result.append(Task("more", "fig3", draw_fig3, {"number": 4}))
    return result


def judge_counts(number: int, voxel_size_m: float) -> Outcome:
    """Free space found and free travel with 1 to 21 cameras."""
    machine, scene, grid = c_arm(), setup(number), room_grid(voxel_size_m)
    moment, motions = scene.at(machine), room_motions(machine)
    truth = true_occupancy(grid, moment)
    exact = ExactTravel(machine, scene.solids())
    travels = [exact.until_contact(moment.joints, motion).travel for motion in motions]
    said = {"kind": "cameras", "setup": number, **_said("640x480", voxel_size_m), "detail": "pixel"}
    rows = []
    for count in COUNTS:
        views = hung_clear(sensor_cameras("640x480", count=count), scene.solids())
        frames = render(views, moment, noise=False)
        seen = reconstruct(grid, views, frames, rule="any", detail="point", looks=False).free
        space = reconstruct(grid, views, frames, machine=machine, joints=moment.joints, looks=False)
        tally = Tally()
        tally.add(space.free, truth.occupied, truth.machine, seen)
        verdicts = check_motions(space, machine, moment.joints, motions)
        shares = [
            100 * verdict.free_travel / travel
            for verdict, travel in zip(verdicts, travels, strict=True)
            if travel > 0
        ]
        rows.append({**said, "cameras": count, **tally.row(), "travel_pct": mean(shares)})
    return Outcome(rows)


def _said(sensor: str, voxel_size_m: float) -> dict[str, Any]:
    return {"sensor": sensor, "noise": False, "voxel_size_m": voxel_size_m, "rule": "three"}


def judge_balls(sensor: str, voxel_size_m: float) -> Outcome:
    """Balls of each size in the bare room, by the thesis' test and ours."""
    grid = room_grid(voxel_size_m)
    views = sensor_cameras(sensor)
    said = {"kind": "balls", **_said(sensor, voxel_size_m)}
    rows: list[dict[str, Any]] = []
    for size in SIZES_M:
        balls = hung_balls(size)
        everything = Solid("balls", join([part for _, part in balls]), np.eye(4))
        moment = Moment(1.0, (*shell(), everything), {})
        frames = render(views, moment, noise=False)
        touched = [touched_by(grid, solid) for solid, _ in balls]
        for detail in ("point", "footprint", "pixel"):
            free = reconstruct(grid, views, frames, detail=detail, looks=False).free
            wrong = [
                free[tuple(slice(c, c + n) for c, n in zip(corner, part.shape, strict=True))][part]
                for corner, part in touched
            ]
            rows.append(
                {
                    **said,
                    "detail": detail,
                    "size_m": size,
                    "balls": len(balls),
                    "missed_pct": 100 * float(np.mean([w.all() for w in wrong])),
                    "touched_free_pct": 100 * float(np.concatenate(wrong).mean()),
                }
            )
    return Outcome(rows)


def hung_balls(size_m: float) -> list[tuple[Solid, Any]]:
    """Balls of this diameter, spread over the room, each as a solid and as a shape; the same for each size."""
    rng = np.random.default_rng(61)
    places = rng.uniform((-1.5, -1.5, 0.4), (1.5, 1.5, 2.1), (400, 3))
    chosen: list[Any] = []
    for place in places:
        if all(np.linalg.norm(place - other) > 0.32 for other in chosen) and len(chosen) < BALLS:
            chosen.append(place)
    shapes = [ellipsoid(place, (size_m / 2,) * 3, rows=8, columns=14) for place in chosen]
    return [(Solid("ball", join([shape]), np.eye(4)), shape) for shape in shapes]


def draw_fig3(number: int) -> Outcome:
    """The thesis' Fig. 3 of one of the setups."""
    return Outcome([], {"fig3": fig3_picture(setup(number), c_arm())})


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """By number of cameras, the mean of the setups."""
    counts = [row for row in rows if row["kind"] == "cameras"]
    return [
        {
            "kind": "summary",
            "of": "cameras",
            "cameras": count,
            **{
                key: mean([row[key] for row in counts if row["cameras"] == count])
                for key in ("free_pct", "found_pct", "occupied_pct", "travel_pct")
            },
        }
        for count in dict.fromkeys(row["cameras"] for row in counts)
    ]


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Tables, two charts, the figure."""
    blocks: list[Block] = [about(__doc__)]
    counts = [row for row in rows if row["kind"] == "summary"]
    if counts:
        blocks += _counts_blocks(counts)
    balls = [row for row in rows if row["kind"] == "balls"]
    if balls:
        blocks += [_balls_table(balls), _balls_chart(balls)]
    if "fig3" in pictures:
        words = (
            "The thesis' Fig. 3, made by the program: I-IV free space of four sensors, V together, VI the machine, "
            "VII its own place freed, VIII-X new positions, XI-XIII their collisions (red)"
        )
        blocks.append(Picture(pictures["fig3"], words, 1000))
    return blocks


def _counts_blocks(counts: Sequence[Row]) -> list[Block]:
    """Over the number of cameras."""
    table = table_of(
        "More sensors: 640x480, no noise, pixel test [%]",
        counts,
        {
            "cameras": "{cameras}",
            "free of all": lambda r: pct(r["free_pct"]),
            "found of seen": lambda r: pct(r["found_pct"]),
            "occupied": lambda r: pct(r["occupied_pct"], 3),
            "free travel of the truth": lambda r: pct(r["travel_pct"], 1),
        },
        left=("cameras",),
    )
    lines = (
        Line("free space declared, of all", [(r["cameras"], r["free_pct"]) for r in counts]),
        Line("free travel, of the truth", [(r["cameras"], r["travel_pct"]) for r in counts]),
    )
    drawn = chart(lines, "cameras", "%", y_range=(0, 102))
    return [table, Picture(drawn, "Free space and free travel by the number of cameras", 560)]


def _by_sensor(balls: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
    """By sensor and detail."""
    kinds: dict[tuple[str, str], list[Row]] = {}
    for row in balls:
        kinds.setdefault((row["sensor"], row["detail"]), []).append(row)
    return kinds


def _balls_chart(balls: Sequence[Row]) -> Picture:
    drawn = [
        Line(f"{sensor}, {detail}", [(100 * r["size_m"], r["touched_free_pct"]) for r in mine])
        for (sensor, detail), mine in _by_sensor(balls).items()
    ]
    words = "Share of the voxels touched by a ball that are declared free, over its diameter"
    return Picture(chart(drawn, "diameter [cm]", "%", logarithmic=True), words, 560)


def _balls_table(balls: Sequence[Row]) -> Table:
    sizes = sorted({r["size_m"] for r in balls})
    lines = []
    for (sensor, detail), mine in _by_sensor(balls).items():
        by = {r["size_m"]: r for r in mine}
        lines.append(
            (sensor, detail, *(f"{by[s]['missed_pct']:.0f} ({by[s]['touched_free_pct']:.1f})" for s in sizes))
        )
    return Table(
        f"Small objects at {cm(balls[0]['voxel_size_m'])}: missed [%] (touched voxels declared free [%])",
        ("sensor", "detail", *(cm(s) for s in sizes)),
        lines,
        left=(0, 1),
    )


PART = Part("more", "What else the thesis claims", tasks, summary, show)
