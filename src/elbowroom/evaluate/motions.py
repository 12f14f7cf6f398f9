"""Motions (thesis 4.1, 5.1.2, Tables 3 and 4): the 35 movements and random ones, beside exact geometry.

The truth is exact mesh distance; apart from it, the same check in the volume of true voxels. A verdict is *s* if it
is in the same band (S, M, L or 0), *ts* if too safe by one band or two, *tts* by three, *u* if less safe than the
truth. The random motions are those of random poses whose truth lies within L, so that nobody chose them; a *false
stop* is a stop where the truth is none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from elbowroom.evaluate.bands import compared, counted
from elbowroom.evaluate.exact import ExactTravel, load_coal
from elbowroom.evaluate.part import Part
from elbowroom.evaluate.scene import Comparison, room_grid, room_motions
from elbowroom.evaluate.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis import c_arm, sensor_cameras
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.motion import Motion, blocks_in_reach, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.reconstruct.carve import Detail
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Moment, render, setup, true_occupancy
from elbowroom.simulate.machine_solids import random_joints
from elbowroom.view.blocks import Block, Table, Words, cm, pct

SMALL = ("iv pole", "iv line", "gas hose", "cables", "monitor cables", "shield")
"""Solids that are thinner than 0.10 m, what the thesis' sensor can detect."""
CHUNK = 21
"""Random motions of one share of the work."""
CLEAR_M = 0.02
"""Random poses keep this distance of everything [m]."""


@dataclass(frozen=True, slots=True)
class Variant:
    """How a movement is judged."""

    sensor: str
    voxel_size_m: float
    detail: Detail
    noise: bool = False
    lateral_px: float = 0.5


VARIANTS = (
    Variant("640x480", 0.02, "pixel"),
    Variant("640x480", 0.02, "pixel", lateral_px=0.0),
    Variant("640x480", 0.02, "pixel", noise=True),
    Variant("64x48", 0.05, "pixel"),
    Variant("64x48", 0.05, "point"),
)
"""The first is the one that figures are due of; the last is the thesis' own."""


def tasks(settings: Settings) -> list[Task]:
    """One for each setup's movements, and one for every 21 random motions.

    Raises:
        ElbowroomError: coal is not installed.
    """
    load_coal()
    sizes = settings.voxel_sizes_m
    shared = {"cameras": settings.cameras, "voxel_sizes_m": None if sizes is None else list(sizes)}
    fixed = [
        Task(
            "motions",
            f"setup{number}",
            judge_movements,
            {"number": number, "sensors": list(settings.sensors), **shared},
        )
        for number in settings.setups
    ]
    chunks = -(-settings.random_motions // CHUNK)
    left = [min(CHUNK, settings.random_motions - n * CHUNK) for n in range(chunks)]
    edge = min(sizes) if sizes else 0.02
    return fixed + [
        Task(
            "motions",
            f"random{n:02d}",
            judge_random,
            {
                "number": settings.setups[n % len(settings.setups)],
                "seed": n,
                "count": count,
                "cameras": settings.cameras,
                "voxel_size_m": edge,
            },
        )
        for n, count in enumerate(left)
    ]


def judge_movements(
    number: int, sensors: Sequence[str], cameras: int, voxel_sizes_m: Sequence[float] | None
) -> Outcome:
    """All movements of one setup, by all variants."""
    scene, machine = setup(number), c_arm()
    truth = ExactTravel(machine, scene.solids())
    rows = []
    for movement in scene.movements:
        joints = scene.joints_before(movement)
        moment = scene.at(machine, joints)
        motion = _motions(machine)[movement.joint, movement.direction]
        contact = truth.until_contact(joints, motion)
        images: dict[tuple[str, bool], list[DepthFrame]] = {}
        for variant in _variants(sensors, voxel_sizes_m):
            views = _cameras(variant.sensor, variant.noise, cameras)
            key = (variant.sensor, variant.noise)
            if key not in images:
                images[key] = render(views, moment, noise=variant.noise)
            space = _space(machine, moment, [motion], views, images[key], variant)
            (verdict,) = check_motions(space, machine, joints, [motion])
            found = Comparison(motion, verdict, contact)
            volume = _volume_band(machine, moment, motion, variant.voxel_size_m)
            rows.append(
                {
                    "kind": "movement",
                    "setup": number,
                    "motion": movement.name,
                    **_said(variant, cameras),
                    **found.row(),
                    **_judged(found, variant.voxel_size_m),
                    "truth_volume_band": volume,
                    "verdict_by_volume": compared(verdict.band, volume),
                    "thesis_band": movement.thesis_band,
                    "thesis_truth_band": movement.thesis_truth,
                    "thesis_verdict_printed": movement.thesis_verdict,
                    "thesis_verdict": compared(movement.thesis_band, movement.thesis_truth),
                }
            )
    return Outcome(rows)


def judge_random(number: int, seed: int, count: int, cameras: int, voxel_size_m: float) -> Outcome:
    """Random poses in one setup until so many motions of theirs have a truth within L; all motions of the poses."""
    scene, machine = setup(number), c_arm()
    truth = ExactTravel(machine, scene.solids())
    variant = Variant("640x480", voxel_size_m, "pixel")
    views = _cameras(variant.sensor, False, cameras)
    motions = list(_motions(machine).values())
    rng = np.random.default_rng([number, seed])
    rows: list[dict[str, Any]] = []
    within, pose = 0, 0
    while within < count:
        joints = random_joints(machine, rng)
        if truth.gap(joints, CLEAR_M) < CLEAR_M:
            continue
        contacts = [truth.until_contact(joints, motion) for motion in motions]
        if not any(contact.touches for contact in contacts):
            continue
        moment = scene.at(machine, joints)
        space = _space(machine, moment, motions, views, render(views, moment, noise=False), variant)
        for verdict, motion, contact in zip(
            check_motions(space, machine, joints, motions), motions, contacts, strict=True
        ):
            found = Comparison(motion, verdict, contact)
            chosen = contact.touches and within < count
            within += chosen
            rows.append(
                {
                    "kind": "random",
                    "setup": number,
                    "motion": f"random {seed}-{pose}",
                    "within_l": chosen,
                    "joints": joints,
                    **_said(variant, cameras),
                    **found.row(),
                    **_judged(found, voxel_size_m),
                }
            )
        pose += 1
    return Outcome(rows)


@cache
def _motions(machine: Machine) -> dict[tuple[str, int], Motion]:
    return {(motion.joint, motion.direction): motion for motion in room_motions(machine)}


@cache
def _cameras(sensor: str, noise: bool, count: int) -> tuple[DepthCamera, ...]:
    """Kept, since images of what never moves are kept by camera."""
    return sensor_cameras(sensor, noise=noise, count=count)


def _variants(sensors: Sequence[str], voxel_sizes_m: Sequence[float] | None) -> list[Variant]:
    chosen = [v for v in VARIANTS if v.sensor in sensors]
    if voxel_sizes_m is None:
        return chosen
    every = [
        Variant(v.sensor, edge, v.detail, v.noise, v.lateral_px) for v in chosen for edge in voxel_sizes_m
    ]
    return list(dict.fromkeys(every))


def _space(
    machine: Machine,
    moment: Moment,
    motions: Sequence[Motion],
    views: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    variant: Variant,
) -> FreeSpace:
    """Free space where the motions can go."""
    grid = room_grid(variant.voxel_size_m)
    return reconstruct(
        grid,
        views,
        frames,
        machine=machine,
        joints=moment.joints,
        detail=variant.detail,
        margin=Margin(lateral_px=variant.lateral_px),
        focus=blocks_in_reach(grid, machine, moment.joints, motions),
    )


def _volume_band(machine: Machine, moment: Moment, motion: Motion, voxel_size_m: float) -> str:
    """The band of the same check in the volume of true voxels."""
    grid = room_grid(voxel_size_m)
    volume = FreeSpace.from_occupied(grid, true_occupancy(grid, moment).occupied).without(
        machine, moment.joints
    )
    return check_motions(volume, machine, moment.joints, [motion])[0].band


def _said(variant: Variant, cameras: int) -> dict[str, Any]:
    return {
        "sensor": variant.sensor,
        "noise": variant.noise,
        "voxel_size_m": variant.voxel_size_m,
        "rule": "three",
        "detail": variant.detail,
        "lateral_px": variant.lateral_px,
        "cameras": cameras,
    }


def _judged(found: Comparison, voxel_size_m: float) -> dict[str, Any]:
    contact = found.contact
    missing_m = (contact.travel - found.verdict.free_travel) * contact.speed
    return {
        "truth_band": found.true_level.band,
        "truth_travel": contact.travel,
        "verdict": compared(found.verdict.band, found.true_level.band),
        "more_than_truth": found.milder,
        "small_object": contact.solid in SMALL,
        "shortfall_voxels": missing_m / voxel_size_m if contact.touches else None,
    }


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Of each variant its verdicts counted; of the random motions shortfall and false stops by joint."""
    result: list[dict[str, Any]] = []
    same = ("sensor", "noise", "voxel_size_m", "rule", "detail", "lateral_px", "cameras")
    movements = [row for row in rows if row["kind"] == "movement"]
    for values in dict.fromkeys(tuple(row[key] for key in same) for row in movements):
        mine = [row for row in movements if tuple(row[key] for key in same) == values]
        result.append(
            {
                "kind": "summary",
                "of": "movement",
                **dict(zip(same, values, strict=True)),
                "movements": len(mine),
                **counted([row["verdict"] for row in mine]),
                "by_volume": counted([row["verdict_by_volume"] for row in mine]),
                "small_objects": sum(row["small_object"] for row in mine),
                "unsafe_of_small_objects": sum(row["small_object"] and row["verdict"] == "u" for row in mine),
                "thesis_printed": counted([row["thesis_verdict_printed"] for row in mine]),
                "thesis_by_definition": counted([row["thesis_verdict"] for row in mine]),
            }
        )
    drawn = [row for row in rows if row["kind"] == "random"]
    if drawn:
        within = [row for row in drawn if row["within_l"]]
        shortfalls = [row["shortfall_voxels"] for row in within]
        result.append(
            {
                "kind": "summary",
                "of": "random",
                **{key: drawn[0][key] for key in same},
                "motions": len(within),
                **counted([row["verdict"] for row in within]),
                "more_than_truth": sum(row["more_than_truth"] for row in drawn),
                "median_shortfall_voxels": float(np.median(shortfalls)) if shortfalls else None,
                "p90_shortfall_voxels": float(np.percentile(shortfalls, 90)) if shortfalls else None,
            }
        )
        for joint in dict.fromkeys(row["joint"] for row in drawn):
            safe = [row for row in drawn if row["joint"] == joint and row["truth_band"] != "S"]
            stops = sum(row["band"] == "S" for row in safe)
            result.append(
                {
                    "kind": "summary",
                    "of": "false stops",
                    "joint": joint,
                    "motions": len(safe),
                    "false_stops": stops,
                    "false_stop_pct": 100 * stops / len(safe) if safe else None,
                    "clear_where_clear_pct": _clear_pct(safe),
                }
            )
    return result


def _clear_pct(rows: Sequence[Row]) -> float | None:
    clear = [row for row in rows if row["truth_band"] == "0"]
    return 100 * sum(row["band"] == "0" for row in clear) / len(clear) if clear else None


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Verdicts counted beside the thesis', its Table 4 with ours, the random motions."""
    blocks: list[Block] = [Words(" ".join((__doc__ or "").split("\n\n", 1)[1].split()))]
    summaries = [row for row in rows if row["kind"] == "summary"]
    counts = [row for row in summaries if row["of"] == "movement"]
    if counts:
        lines = [
            (
                f"thesis, {words}",
                str(sum(counts[0][key].values())),
                *(str(n) for n in counts[0][key].values()),
                "",
                "",
            )
            for words, key in (
                ("as printed", "thesis_printed"),
                ("by its definition", "thesis_by_definition"),
            )
        ]
        for row in counts:
            volume = row["by_volume"]
            lines.append(
                (
                    f"{row['sensor']}, {cm(row['voxel_size_m'])}, {row['detail']}{', noise' if row['noise'] else ''}"
                    f", +-{row['lateral_px']:g} px",
                    str(row["movements"]),
                    *(str(row[verdict]) for verdict in ("s", "ts", "tts", "u")),
                    " / ".join(str(volume[verdict]) for verdict in ("s", "ts", "tts", "u")),
                    f"{row['unsafe_of_small_objects']} of {row['small_objects']}",
                )
            )
        columns = ("", "movements", "s", "ts", "tts", "u", "by the truth volume", "unsafe, under 0.10 m")
        blocks.append(Table("The movements of Appendix B", columns, lines))
        blocks.append(_table_4(rows))
    for row in summaries:
        if row["of"] == "random":
            blocks.append(_random_table(row))
    stops = [row for row in summaries if row["of"] == "false stops"]
    if stops:
        blocks.append(
            Table(
                "False stops in random poses, by joint: of motions whose truth is not within S",
                ("joint", "motions", "false stops", "[%]", "0 where the truth is 0 [%]"),
                [
                    (
                        row["joint"],
                        str(row["motions"]),
                        str(row["false_stops"]),
                        pct(row["false_stop_pct"], 1),
                        pct(row["clear_where_clear_pct"], 1),
                    )
                    for row in stops
                ],
            )
        )
    return blocks


def _table_4(rows: Sequence[Row]) -> Table:
    first = [r for r in rows if r["kind"] == "movement"]
    main = [r for r in first if [r[k] for k in _KEYS] == [first[0][k] for k in _KEYS]]
    lines = [
        (
            str(r["setup"]),
            r["motion"],
            f"{r['thesis_band']} / {r['thesis_truth_band']} {r['thesis_verdict_printed']}",
            f"{r['band']} / {r['truth_band']} {r['verdict']}",
            f"{r['free_travel']:.3f}",
            f"{r['truth_travel']:.3f} {r['free_travel_unit']}",
            r["cause"],
            r["true_solid"] or "",
        )
        for r in main
    ]
    words = f"{main[0]['sensor']}, {cm(main[0]['voxel_size_m'])}, {main[0]['detail']}"
    return Table(
        f"Each movement: band found / true band and verdict ({words}); rooms and poses are not the thesis' own",
        ("setup", "movement", "thesis", "ours", "free travel", "truth", "ended by", "truly touches"),
        lines,
        left=(0, 1, 2, 3, 6, 7),
    )


_KEYS = ("sensor", "noise", "voxel_size_m", "detail", "lateral_px")


def _random_table(row: Row) -> Table:
    lines = [
        ("motions whose truth is within L", str(row["motions"]), ""),
        ("unsafe", str(row["u"]), "0"),
        ("more free travel than the truth, all motions of the poses", str(row["more_than_truth"]), "0"),
        ("same band", str(row["s"]), ""),
        ("too safe by one band or two", str(row["ts"]), ""),
        ("too safe by three", str(row["tts"]), ""),
        (
            "median shortfall of free travel [voxels of the moving point]",
            f"{row['median_shortfall_voxels']:.2f}",
            "2",
        ),
        ("90 % shortfall", f"{row['p90_shortfall_voxels']:.2f}", ""),
    ]
    return Table(
        f"Random motions, {row['sensor']}, {cm(row['voxel_size_m'])}, {row['detail']}",
        ("", "found", "due"),
        lines,
    )


PART = Part("motions", "Motions", tasks, summary, show)
