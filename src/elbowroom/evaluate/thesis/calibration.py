"""Calibration error (thesis 6.1.2): cameras that are not quite where they are said to be.

Each camera's said pose is turned about its own three axes by angles drawn evenly from +-a, and moved along the world's
axes by lengths drawn evenly from +-b. The *declared margin* for errors up to a and b is three quarters of them: pixels
are widened by f a + f b / 2.5 m, and depth is trusted to b + a z. The curves look at a fixed third of the room.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from elbowroom.evaluate.due import figure_of, where
from elbowroom.evaluate.shares.task import Row, Settings, Task
from elbowroom.evaluate.thesis.calibration_blocks import calibration_blocks
from elbowroom.evaluate.thesis.draws import MARGIN, MEASURES, Errors, judge_draws
from elbowroom.evaluate.thesis.due import DueLine
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.view.report.blocks import Block, mean

VOXEL_M = 0.05
ROTATIONS_DEG = (1.0, 2.0, 3.0)
TRANSLATIONS_M = (0.01, 0.02, 0.05)
SHARES = (0.25, 0.5, 1.0, 1.5)
"""Margins besides 0 and the declared one whose effect is shown."""
SAME = ("curve", "setup", "sensor", "voxel_size_m", "detail", "rotation_deg", "translation_m", "margin_share")
"""What draws of one case and margin have in common."""
CHUNK = 25
"""Draws of one share of the work."""


def _is_due(row: Row) -> bool:
    """The greatest errors of which figures are due, with the declared margin."""
    return where(kind="summary", curve="due")(row) and row["margin_share"] > 0


DUE = (
    DueLine(
        "occupied_pct",
        "≥",
        99.99,
        _is_due,
        name="+-1 degree, +-1 cm, declared margin, 5 cm: occupied [%]",
        thesis="unchanged",
        digits=4,
    ),
    DueLine("found_pct", "≥", 75.0, _is_due, name="and found of what is seen [%]", thesis="unchanged"),
)


def tasks(settings: Settings) -> list[Task]:
    """Draws of the due case, of margins for it, of the curves, and of the thesis' own sensor and test."""
    result = []
    for errors in _cases():
        draws = 1 if errors.are_none else settings.draws
        for first in range(0, draws, CHUNK):
            words = f"{errors.rotation_deg:g}deg-{errors.translation_m * 1000:g}mm-{first:03d}"
            arguments = {
                "errors": {**asdict(errors), "shares": list(errors.shares)},
                "number": settings.setups[0],
                "voxel_size_m": settings.voxel_sizes_m[0] if settings.voxel_sizes_m else VOXEL_M,
                "cameras": settings.cameras,
                "first": first,
                "draws": min(CHUNK, draws - first),
            }
            result.append(Task("calibration", f"{errors.curve}-{words}", judge_draws, arguments))
    return result


def _cases() -> list[Errors]:
    one_degree, one_cm = 1.0, 0.01
    return [
        Errors("due", "vga", one_degree, one_cm, (0.0, MARGIN), whole=True),
        Errors("margins", "vga", one_degree, one_cm, SHARES),
        *(Errors("rotation", "qqvga", a, 0.0, (0.0, MARGIN)) for a in (0.0, *ROTATIONS_DEG)),
        *(Errors("translation", "qqvga", 0.0, b, (0.0, MARGIN)) for b in TRANSLATIONS_M),
        *(
            Errors("thesis", "thesis", a, b, (0.0,), whole=True, detail="point")
            for a, b in ((0.0, 0.0), (one_degree, 0.0), (0.0, one_cm))
        ),
    ]


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Mean and worst of the draws of each case and margin."""
    result = []
    for values in dict.fromkeys(tuple(row[key] for key in SAME) for row in rows):
        mine = [row for row in rows if tuple(row[key] for key in SAME) == values]
        each = {key: [value for row in mine for value in row["each"][key]] for key in MEASURES}
        result.append(
            {
                "kind": "summary",
                **dict(zip(SAME, values, strict=True)),
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
    due = ", ".join(f"{figure_of(DUE, key):g}" for key in ("occupied_pct", "found_pct"))
    return [about(__doc__), *calibration_blocks(rows, due)]


PART = Part("calibration", "Calibration error", tasks, summary, show, DUE)
