"""The 35 movements of the thesis' Appendix B by several sensors, beside exact geometry and the true volume."""

from collections.abc import Iterator, Sequence
from typing import Any

from elbowroom.evaluate.due import where
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.scene import Comparison, room_grid
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis.bands import compared, counted
from elbowroom.evaluate.thesis.due import DueLine, first
from elbowroom.evaluate.thesis.judged import (
    LATERAL_PX,
    SAID,
    Variant,
    cameras_of,
    is_small,
    judged,
    motions_of,
    seen_space,
)
from elbowroom.evaluate.thesis.thesis import c_arm
from elbowroom.machine import Machine
from elbowroom.motion import Motion, check_motions
from elbowroom.reconstruct import FreeSpace
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, Movement, Setup, render, setup, true_occupancy
from elbowroom.view.report.blocks import Block, Table, cm

VARIANTS = (
    Variant("640x480", 0.02, "pixel"),
    Variant("640x480", 0.02, "pixel", lateral_px=LATERAL_PX),
    Variant("640x480", 0.02, "pixel", noise=True),
    Variant("640x480", 0.02, "pixel", noise=True, lateral_px=LATERAL_PX),
    Variant("640x480", 0.04, "pixel"),
    Variant("640x480", 0.04, "pixel", noise=True),
    Variant("64x48", 0.05, "pixel"),
    Variant("64x48", 0.05, "pixel", lateral_px=LATERAL_PX),
    Variant("64x48", 0.05, "point"),
)
"""The first is the one that figures are due of; the last is the thesis' own. Voxels of 4 cm are looked at again in
parts of 1 cm where motions would stop: one space of both sizes."""
VERDICTS = ("s", "ts", "tts", "u")


def _right(row: Row) -> float:
    """31 of the 35."""
    return 31 * float(row["movements"]) / 35


_OF = where(kind="summary", of="movement")
DUE = (
    DueLine("u", "≤", 0, _OF, name="movements: unsafe, of {movements}", thesis="2", pick=first),
    DueLine("unsafe_of_small_objects", "≤", 0, _OF, name="and of small objects", thesis="2", pick=first),
    DueLine(
        "s",
        "≥",
        _right,
        _OF,
        name="movements: right band, of {movements}",
        thesis="27",
        digits=0,
        pick=first,
    ),
    DueLine("tts", "≤", 0, _OF, name="movements: too safe by three bands", thesis="1", pick=first),
)


def movement_tasks(settings: Settings) -> list[Task]:
    """One for each setup's movements."""
    sizes = settings.voxel_sizes_m
    return [
        Task(
            "motions",
            f"setup{number}",
            judge_movements,
            {
                "number": number,
                "sensors": list(settings.sensors),
                "cameras": settings.cameras,
                "voxel_sizes_m": None if sizes is None else list(sizes),
            },
        )
        for number in settings.setups
    ]


def judge_movements(
    number: int, sensors: Sequence[str], cameras: int, voxel_sizes_m: Sequence[float] | None
) -> Outcome:
    """All movements of one setup, by all variants.

    Args:
        number: of the setup.
        sensors: names of `SENSORS`; variants of others are left out.
        cameras: how many.
        voxel_sizes_m: edges of voxels [m]; None: the variants' own.
    """
    scene = setup(number)
    truth = ExactTravel(c_arm(), scene.solids())
    variants = _variants(sensors, voxel_sizes_m)
    said = {"kind": "movement", "setup": number}
    return Outcome(
        [
            said | row
            for movement in scene.movements
            for row in _judged(scene, movement, truth, variants, cameras)
        ]
    )


def _judged(
    scene: Setup, movement: Movement, truth: ExactTravel, variants: Sequence[Variant], cameras: int
) -> Iterator[dict[str, Any]]:
    """One movement by all variants; each sensor's images are rendered once."""
    machine, joints = c_arm(), scene.joints_before(movement)
    moment = scene.at(machine, joints)
    bare = Moment(moment.time_s, scene.solids(), joints)
    motion = motions_of(machine)[movement.joint, movement.direction]
    contact = truth.until_contact(joints, motion)
    edges = {variant.voxel_size_m for variant in variants}
    volumes = {edge: _volume_band(machine, bare, motion, edge) for edge in edges}
    images: dict[tuple[str, bool], list[DepthFrame]] = {}
    for variant in variants:
        key = (variant.sensor, variant.noise)
        views = cameras_of(*key, cameras)
        if key not in images:
            images[key] = render(views, moment, noise=variant.noise)
        space = seen_space(machine, moment, [motion], views, images[key], variant)
        (verdict,) = check_motions(space, machine, joints, [motion])
        volume = volumes[variant.voxel_size_m]
        yield {
            "motion": movement.name,
            **variant.said(cameras),
            **judged(Comparison(motion, verdict, contact), variant.voxel_size_m),
            "truth_volume_band": volume,
            "verdict_by_volume": compared(verdict.band, volume),
            "thesis_band": movement.thesis_band,
            "thesis_truth_band": movement.thesis_truth,
            "thesis_verdict_printed": movement.thesis_verdict,
            "thesis_verdict": compared(movement.thesis_band, movement.thesis_truth),
        }


def _variants(sensors: Sequence[str], voxel_sizes_m: Sequence[float] | None) -> list[Variant]:
    chosen = [v for v in VARIANTS if v.sensor in sensors]
    if voxel_sizes_m is None:
        return chosen
    every = [
        Variant(v.sensor, edge, v.detail, v.noise, v.lateral_px) for v in chosen for edge in voxel_sizes_m
    ]
    return list(dict.fromkeys(every))


def _volume_band(machine: Machine, moment: Moment, motion: Motion, voxel_size_m: float) -> str:
    """The band of the same check in the volume of true voxels; the moment has no machine in it."""
    grid = room_grid(voxel_size_m)
    volume = FreeSpace.from_occupied(grid, true_occupancy(grid, moment).occupied).without(
        machine, moment.joints
    )
    return check_motions(volume, machine, moment.joints, [motion])[0].band


def movement_summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Of each variant its verdicts counted."""
    movements = [row for row in rows if row["kind"] == "movement"]
    result = []
    for values in dict.fromkeys(_values(row) for row in movements):
        mine = [row for row in movements if _values(row) == values]
        small = [row for row in mine if is_small(row)]
        result.append(
            {
                "kind": "summary",
                "of": "movement",
                **dict(zip(SAID, values, strict=True)),
                "movements": len(mine),
                **counted([row["verdict"] for row in mine]),
                "by_volume": counted([row["verdict_by_volume"] for row in mine]),
                "small_objects": len(small),
                "unsafe_of_small_objects": sum(row["verdict"] == "u" for row in small),
                "thesis_printed": counted([row["thesis_verdict_printed"] for row in mine]),
                "thesis_by_definition": counted([row["thesis_verdict"] for row in mine]),
            }
        )
    return result


def _values(row: Row) -> tuple[Any, ...]:
    return tuple(row[key] for key in SAID)


def movement_blocks(rows: Sequence[Row]) -> list[Block]:
    """Verdicts counted beside the thesis', and its Table 4 with ours."""
    counts = [row for row in rows if row["kind"] == "summary" and row["of"] == "movement"]
    if not counts:
        return []
    lines = []
    for words, key in (("as printed", "thesis_printed"), ("by its definition", "thesis_by_definition")):
        printed = counts[0][key]
        lines.append((f"thesis, {words}", str(sum(printed.values())), *map(str, printed.values()), "", ""))
    for row in counts:
        lines.append(
            (
                f"{row['sensor']}, {cm(row['voxel_size_m'])}, {row['detail']}{', noise' if row['noise'] else ''}"
                f", +-{row['lateral_px']:g} px",
                str(row["movements"]),
                *(str(row[verdict]) for verdict in VERDICTS),
                " / ".join(str(row["by_volume"][verdict]) for verdict in VERDICTS),
                f"{row['unsafe_of_small_objects']} of {row['small_objects']}",
            )
        )
    columns = ("", "movements", *VERDICTS, "by the truth volume", "unsafe, under 0.10 m")
    return [Table("The movements of Appendix B", columns, lines), _table_4(rows)]


def _table_4(rows: Sequence[Row]) -> Table:
    movements = [row for row in rows if row["kind"] == "movement"]
    main = [row for row in movements if _values(row) == _values(movements[0])]
    lines = [
        (
            str(row["setup"]),
            row["motion"],
            f"{row['thesis_band']} / {row['thesis_truth_band']} {row['thesis_verdict_printed']}",
            f"{row['band']} / {row['truth_band']} {row['verdict']}",
            f"{row['free_travel']:.3f}",
            f"{row['truth_travel']:.3f} {row['free_travel_unit']}",
            row["cause"],
            row["true_solid"] or "",
        )
        for row in main
    ]
    words = f"{main[0]['sensor']}, {cm(main[0]['voxel_size_m'])}, {main[0]['detail']}"
    return Table(
        f"Each movement: band found / true band and verdict ({words}); rooms and poses are not the thesis' own",
        ("setup", "movement", "thesis", "ours", "free travel", "truth", "ended by", "truly touches"),
        lines,
        left=(0, 1, 2, 3, 6, 7),
    )
