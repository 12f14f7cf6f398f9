"""Results as Markdown tables, the figure that is due beside the measured one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

Row = Mapping[str, Any]
Cell = Callable[[Row], str]
Due = Callable[[Row], tuple[str, float] | None]


def table(rows: Iterable[Row], columns: Mapping[str, Cell]) -> list[str]:
    """Rows as a Markdown table."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(cell(row) for cell in columns.values()) + " |" for row in rows]
    return lines


def plain(value: Any) -> str:
    """A value as a cell: yes or no, a few digits, or nothing."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {plain(item)}" for key, item in value.items())
    return str(value)


def of(key: str, digits: int | None = None, *, due: Due | None = None) -> Cell:
    """A cell with one value of the row.

    Args:
        key: of the value.
        digits: after the point; None: as it comes.
        due: what the value should be, as ("≤" or "≥", figure); None, or None of a row: nothing is due.
    """

    def cell(row: Row) -> str:
        value = row.get(key)
        wanted = due(row) if due is not None else None
        text = plain(value) if digits is None or value is None else f"{value:.{digits}f}"
        if wanted is None:
            return text
        sign, figure = wanted
        if value is None:
            return f"not measured (due {sign} {figure:g})"
        met = value <= figure if sign == "≤" else value >= figure
        return f"{text} (due {sign} {figure:g})" if met else f"**{text}** (due {sign} {figure:g}: missed)"

    return cell


def same(*keys: str) -> dict[str, Cell]:
    """Columns that are headed by the keys of their values."""
    return {key: of(key) for key in keys}


def at_most(figure: float) -> Due:
    """Due of every row."""
    return lambda row: ("≤", figure)


def at_least(figure: float) -> Due:
    """Due of every row."""
    return lambda row: ("≥", figure)


def centimetres(row: Row) -> str:
    """The edge of a voxel."""
    return "" if row.get("voxel_size_m") is None else f"{row['voxel_size_m'] * 100:g} cm"


def is_full_room(row: Row) -> bool:
    """Whether the figures that are due speak of a row's cameras."""
    return (row.get("cameras"), row.get("width"), row.get("height")) == (21, 640, 480)


STAGE = "cycle/"
"""Cases that begin so are stages of the cycle."""
KIND = ("voxel_size_m", "detail", "noise")
"""What tells one cycle from another."""
MEDIAN_MS = {
    ("carve", 0.05, "footprint"): 25.0,
    ("carve", 0.02, "footprint"): 130.0,
    ("cycle", 0.05, "footprint"): 45.0,
    ("cycle", 0.02, "footprint"): 180.0,
    ("cycle", 0.05, "pixel"): 140.0,
    ("cycle", 0.02, "pixel"): 480.0,
}
"""Due [ms], by case, edge of a voxel and detail."""


def _due_ms(row: Row) -> tuple[str, float] | None:
    figure = MEDIAN_MS.get((row.get("case"), row.get("voxel_size_m"), row.get("detail")))
    return None if figure is None or not is_full_room(row) else ("≤", figure)


def _due_memory(row: Row) -> tuple[str, float] | None:
    return ("≤", 600.0) if row.get("voxel_size_m") == 0.02 and is_full_room(row) else None


def bench_tables(rows: Sequence[Row]) -> list[str]:
    """Times, then the stages of a cycle."""
    whole = [row for row in rows if "/" not in str(row.get("case"))]
    lines = table(
        whole,
        {
            **same("case"),
            "voxel": centimetres,
            "cameras": lambda row: f"{row.get('cameras')} x {row.get('width')}x{row.get('height')}",
            **same("detail", "noise", "threads"),
            "median ms": of("median_ms", 1, due=_due_ms),
            "99 % ms": of("p99_ms", 1),
            "worst ms": of("max_ms", 1),
            "peak MB": of("peak_rss_mb", 0, due=_due_memory),
            "ratio": of("ratio", 2),
        },
    )
    lines += _against_octomap(rows)
    stages = _stages(row for row in rows if str(row.get("case")).startswith(STAGE))
    return [*lines, "", "Stages of the cycle, medians:", "", *stages] if stages else lines


def _against_octomap(rows: Sequence[Row]) -> list[str]:
    lines = []
    for row in rows:
        if times := row.get("times_slower_than_carve"):
            met = "" if times >= 500 else ": missed"
            lines += [
                "",
                f"OctoMap takes {times:.0f} times as long as carve on the same images (due ≥ 500{met}).",
            ]
    return lines


def _stages(rows: Iterable[Row]) -> list[str]:
    """A line for each kind of cycle, a column for each stage; nothing of no rows."""
    kinds: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        kind = {key: row[key] for key in KIND}
        line = kinds.setdefault(tuple(kind.values()), kind)
        line[row["case"].removeprefix(STAGE)] = row["median_ms"]
    names = dict.fromkeys(name for line in kinds.values() for name in line if name not in KIND)
    columns: dict[str, Cell] = {"voxel": centimetres, **same("detail", "noise")}
    columns |= {f"{name} ms": of(name, 1) for name in names}
    return table(kinds.values(), columns) if kinds else []


def _due_occupied(row: Row) -> tuple[str, float] | None:
    if row.get("rule") != "three" or not is_full_room(row):
        return None
    if row.get("noise"):
        return ("≥", 99.99) if (row.get("detail"), row.get("voxel_size_m")) == ("pixel", 0.02) else None
    return {"footprint": ("≥", 100.0), "pixel": ("≥", 99.99)}.get(str(row.get("detail")))


def _due_found(row: Row) -> tuple[str, float] | None:
    if row.get("rule") != "three" or row.get("detail") != "pixel" or not is_full_room(row):
        return None
    figures = {(0.02, False): 97.0, (0.05, False): 94.0, (0.02, True): 92.0}
    figure = figures.get((row.get("voxel_size_m", 0.0), bool(row.get("noise"))))
    return None if figure is None else ("≥", figure)


def room_tables(rows: Sequence[Row]) -> list[str]:
    """Occupied and found, by voxel size, noise and detail."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("detail", "rule", "noise"),
            "occupied kept %": of("occupied_pct", 4, due=_due_occupied),
            "falsely free voxels": lambda row: (
                f"{row.get('false_free_voxels', 0):,} of {row.get('occupied_voxels', 0):,}"
            ),
            "found %": of("found_pct", 2, due=_due_found),
            "free %": of("free_pct", 2),
        },
    )


def _due_free(row: Row) -> tuple[str, float] | None:
    figures = {"three": 10.0, "majority": 10.0, "veto": 16.0, "any": 20.0}
    return (
        ("≥", figures[row["rule"]])
        if row.get("voxel_size_m") == 0.05 and row.get("rule") in figures
        else None
    )


def sevenscenes_tables(rows: Sequence[Row]) -> list[str]:
    """Falsely free check points and free voxels, by rule, detail and margin."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("rule", "detail", "margin"),
            "false %": of("false_pct", 3, due=lambda row: ("≤", 0.30) if _due_free(row) else None),
            "free %": of("free_pct", 2, due=_due_free),
        },
    )


def _summaries(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if row.get("kind") == "summary"]


def alone_tables(rows: Sequence[Row]) -> list[str]:
    """Levels of all verdicts, by voxel size."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("detail", "poses", "verdicts", "stop", "decelerate", "inform", "clear"),
            "clear %": of("clear_pct", 2, due=at_least(100.0)),
        },
    )


def poses_tables(rows: Sequence[Row]) -> list[str]:
    """Verdicts beside the truth."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("detail", "poses", "verdicts"),
            "milder than the truth": of("milder", due=at_most(0)),
            "truly clear": of("truly_clear"),
            "of these stop %": of("stop_where_clear_pct", 2, due=at_most(10.0)),
            "the very level of the truth %": of("same_level_pct", 2),
        },
    )


def travel_tables(rows: Sequence[Row]) -> list[str]:
    """Free travel beside the truth."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("poses"),
            "more than the truth": of("more_than_truth", due=at_most(0)),
            "something is touched": of("touching"),
            "median shortfall, voxels": of("median_shortfall_voxels", 2, due=at_most(1.5)),
            "greatest shortfall, voxels": of("greatest_shortfall_voxels", 2),
        },
    )


def any_tables(rows: Sequence[Row]) -> list[str]:
    """All that rows say, a column each."""
    names = dict.fromkeys(key for row in rows for key in row if key not in ("kind", "voxel_size_m"))
    columns: dict[str, Cell] = {"voxel": centimetres} if any("voxel_size_m" in row for row in rows) else {}
    columns |= {name.replace("_pct", " %").replace("_", " "): of(name) for name in names}
    return table(rows, columns)


EVEN_CAMERAS = 21
"""Spread evenly, what a layout of the same share is compared with."""


def placement_tables(rows: Sequence[Row]) -> list[str]:
    """Time of verification and sweep, optimised layouts, prediction beside what is found."""
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in {row["kind"] for row in rows}}
    lines = table(
        [*kinds.get("verify", []), *kinds.get("sweep", [])],
        {
            "what": lambda row: (
                f"{row['cameras']} cameras, {row['points']:,} points"
                if row["kind"] == "verify"
                else f"{row['layouts']} layouts at {centimetres(row)}"
            ),
            "seconds": lambda row: (
                of("median_s", 2, due=lambda _: ("≤", 1.0))(row)
                if row["kind"] == "verify"
                else of("seconds", 1, due=lambda _: ("≤", 60.0))(row)
            ),
        },
    )
    lines += [
        "",
        *table(
            kinds.get("optimise", []),
            {
                "optimised for": of("what"),
                "cameras": of("cameras", due=_due_cameras),
                "valid, verified [%]": of(
                    "valid_pct", 2, due=lambda row: ("≥", round(row["wanted_share_pct"], 2))
                ),
                "bound": of("bound"),
                "candidates": of("candidates"),
                "points": of("points"),
                "19 or fewer after [s]": of("seconds_to_19", 0, due=lambda _: ("≤", 300.0)),
                "seconds": of("seconds", 0),
            },
        ),
    ]
    lines += [
        "",
        *table(
            kinds.get("prediction", []),
            {
                "room": of("room"),
                "images": of("size"),
                "voxel": centimetres,
                "scenes": of("scenes"),
                "predicted [%]": lambda row: (
                    f"{row['predicted_free_pct']:.2f} ± {row['predicted_error_pct']:.2f}"
                ),
                "found [%]": of("found_free_pct", 2),
                "apart at most [points]": lambda row: of("apart", 2, due=lambda _: ("≤", 1.0))(
                    {"apart": abs(row["difference_pct"])}
                ),
            },
        ),
    ]
    return lines


def _due_cameras(row: Row) -> tuple[str, float]:
    return ("≤", EVEN_CAMERAS if row["wanted_share_pct"] == 98.9 else EVEN_CAMERAS * 3 // 4)


def sweep_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each room and sensor: the share at some numbers of cameras, the least number, the time."""
    shares = {
        (row["room"], row["sensor"], row["cameras"]): row["valid_pct"]
        for row in rows
        if row["kind"] == "layout"
    }

    def share(count: int) -> Cell:
        return lambda row: plain(round(shares[row["room"], row["sensor"], count], 2))

    return table(
        [row for row in rows if row["kind"] == "sweep"],
        {
            "room": of("room"),
            "sensor": of("sensor"),
            **{f"{count} cameras [%]": share(count) for count in (8, 12, 16, 21, 30, 40)},
            "least": lambda row: plain(row["least_cameras"]) or "none",
            "seconds": of("seconds", 1, due=lambda _: ("≤", 60.0)),
        },
    )


def drift_tables(rows: Sequence[Row]) -> list[str]:
    """Knocks, wrong joints, pushed furniture, false alarms, time."""
    parts = {part: [row for row in rows if row["part"] == part] for part in {row["part"] for row in rows}}
    noise: dict[str, Cell] = {"noise": of("noise")}
    lines = table(
        parts.get("knocks", []),
        {
            "knock": of("knock"),
            **noise,
            "runs": of("runs"),
            "named": of("named", due=lambda row: ("≥", row["runs"])),
            "others": of("others_named", due=lambda _: ("≤", 0)),
            "frames, median": of("frames_median", 0),
            "frames, most": of("frames_max", due=lambda _: ("≤", 60)),
            "said, median": lambda row: f"{row['said_median']:.2f} {row['unit']}" if "unit" in row else "",
            "error, 95 %": lambda row: f"{row['error_p95']:.2f} {row['unit']}" if "unit" in row else "",
            "within 2 σ %": of("inside_2_sigma_pct", 0),
        },
    )
    lines += ["", *table(
        parts.get("joints", []),
        {
            "joint": of("joint"),
            "says too much by": lambda row: (
                f"{row['wrong_by'] * 1e3:.0f} mm" if row["joint"] == "long" else f"{row['wrong_by'] * 57.29578:.0f}°"
            ),
            **noise,
            "found": of("found"),
            "frames": of("frames"),
            "cameras named": of("cameras_named", due=lambda _: ("≤", 0)),
            "said": of("reason"),
        },
    )]  # fmt: skip
    lines += ["", *table(
        parts.get("furniture", []),
        {"pushed": of("what"), **noise, "cameras named": of("cameras_named", due=lambda _: ("≤", 0))},
    )]  # fmt: skip
    lines += ["", *table(
        parts.get("alarms", []),
        {
            **noise,
            "passes": of("passes"),
            "camera frames": of("camera_frames", due=lambda _: ("≥", 10_000)),
            "false alarms": of("false_alarms", due=lambda _: ("≤", 0)),
            "frames that said moved %": of("frames_that_said_moved_pct", 3),
            "frames that could not tell %": of("frames_that_could_not_tell_pct", 2),
        },
    )]  # fmt: skip
    lines += ["", *table(
        parts.get("real", []),
        {
            "recording": of("site"),
            "knock of one camera": of("knock"),
            "named": of("named"),
            "others": of("others_named", due=lambda _: ("≤", 0)),
            "passes": of("passes"),
            "said": lambda row: (
                "" if row["said"] is None else f"{row['said']:.2f} ± {row['two_sigma']:.2f} {row['unit']}"
            ),
        },
    )]  # fmt: skip
    lines += ["", *table(
        parts.get("time", []),
        {
            "a pass": lambda row: f"{row['cameras']} cameras {row['width']}x{row['height']}, with body",
            "median ms": of("median_ms", 1, due=lambda _: ("≤", 3.0)),
            "99 % ms": of("p99_ms", 1),
            "worst ms": of("max_ms", 1),
            "processor time, median ms": of("cpu_median_ms", 1),
        },
    )]  # fmt: skip
    return lines


def calibration_tables(rows: Sequence[Row]) -> list[str]:
    """Captures, the room, coverage, real recordings, each with its own columns."""
    lines: list[str] = []
    for kind, keys in CALIBRATION_COLUMNS.items():
        mine = [row for row in rows if row["kind"] == kind]
        if mine:
            lines += ["", *table(mine, {key: of(key, due=_due_of(key)) for key in keys})]
    return lines


CALIBRATION_COLUMNS = {
    "extrinsics": (
        "case",
        "world",
        "noise",
        "cameras",
        "poses",
        "views",
        "worst_mm",
        "worst_deg",
        "median_mm",
        "median_deg",
        "inside_pct",
        "seconds",
    ),
    "room": (
        "case",
        "noise",
        "occupied_pct",
        "found_pct",
        "sensor_lateral_px",
        "pose_lateral_px",
        "pose_bias_mm",
        "margin_held_pct",
    ),
    "coverage": ("case", "cameras", "poses", "draws", "inside_pct", "margin_held_pct", "mean_square"),
    "images": (
        "case",
        "noise",
        "poses",
        "views",
        "bias_px",
        "bias_sigma_px",
        "common_px",
        "within_px",
        "said_px",
        "inside_pct",
        "mean_square",
    ),
    "real": ("case", "agree_pct", "shares_pct", "note"),
    "machine": (
        "cameras",
        "poses",
        "worst_mm",
        "worst_deg",
        "median_mm",
        "median_deg",
        "inside_pct",
        "seconds",
    ),
    "refine": ("start", "agree_pct", "note"),
    "intrinsics": ("case", "views", "worst_focal_pct", "focal_error_pct", "seconds"),
}


def _due_of(key: str) -> Due:
    """The row's own due figure; at least for shares, at most for errors and times."""

    def due(row: Row) -> tuple[str, float] | None:
        wanted = row.get("due", {}).get(key)
        if not isinstance(wanted, int | float) or not isinstance(row.get(key), int | float):
            return None
        is_error = key.startswith("worst") or not key.endswith("_pct")
        return ("≤" if is_error else "≥", float(wanted))

    return due
