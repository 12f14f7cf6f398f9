"""The pages of `elbowroom calibrate machine` and `refine`: residuals in mm, pictures of measured beside expected."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.calibrate.from_machine.target import MachineCalibration
from elbowroom.calibrate.refinement.refine import Refinement
from elbowroom.calibrate.result.change import change_table
from elbowroom.calibrate.result.surface_picture import SurfacePicture
from elbowroom.view.draw.depth import depth_picture
from elbowroom.view.report.blocks import Block, Picture, Table, Words

SHOWN_M = 0.05
"""Differences of this size have the strongest colour [m]."""
NEARER, EXACT, FARTHER, NOTHING = (0, 90, 181), (247, 247, 247), (200, 60, 20), (120, 124, 130)
"""Blue, white, red: apart in lightness from grey, and for colour-blind eyes from each other."""
PICTURE_WIDTH_PX = 900

Section = tuple[str, list[Block]]


def machine_sections(found: MachineCalibration, rows: Sequence[Mapping[str, Any]]) -> list[Section]:
    """Titles and blocks of the page of `calibrate machine`.

    Args:
        found: what was found.
        rows: of kind "camera", as `change_rows` makes them.
    """
    words = (
        f"{found.poses} poses of {found.machine.name}. Residuals are measured depth minus the model's, of the pixels "
        "that agree with the model. Pixels that see through the model would say that the machine is not where its "
        "joints and the pose say."
    )
    if found.base_covariance is not None:
        sigma_m, sigma_deg = _sigmas(found.base_covariance)
        place = ", ".join(f"{value:.4f}" for value in found.machine.world_from_base[:3, 3])
        words += f" The machine's base is at ({place}) m, sure to {sigma_m * 1e3:.2f} mm and {sigma_deg:.3f} degrees."
    overview: list[Block] = [Words(words), change_table(rows), _notes(found.cameras)]
    return [
        ("What was found", overview),
        ("Residuals", [_machine_table(found)]),
        ("Measured, expected, difference", [_picture(one) for one in found.pictures]),
    ]


def refine_sections(found: Refinement, rows: Sequence[Mapping[str, Any]]) -> list[Section]:
    """Titles and blocks of the page of `calibrate refine`; arguments as of `machine_sections`."""
    words = (
        f"{found.moments} moments of the room, {len(found.pairs)} pairs of cameras. Each camera was moved no farther "
        "than the covariance of its pose allows (99 %)."
    )
    overview: list[Block] = [Words(words), change_table(rows), _notes(found.cameras)]
    return [
        ("What was found", overview),
        ("How well pairs of cameras agree", [pair_table(found)]),
        ("Measured, expected, difference", [_picture(one) for one in found.pictures]),
    ]


def pair_table(found: Refinement, worst: int | None = None) -> Table:
    """Shares of co-visible pixels that agree within 5 cm, before and after.

    Args:
        found: what was found.
        worst: so many pairs, those that agree least; None: all.
    """
    pairs, which = found.pairs, ""
    if worst is not None and len(pairs) > worst:
        pairs = tuple(sorted(pairs, key=lambda pair: pair.after.agree_pct)[:worst])
        which = f"The {worst} of {len(found.pairs)} pairs that agree least (--report and --json have all). "
    return Table(
        f"{which}Pixels of the one whose points the other looks at: agree within 5 cm, are hidden, are seen through "
        "[%]",
        ("one", "other", "compared", "agree before", "agree", "hidden", "seen through"),
        [
            (
                pair.one,
                pair.other,
                f"{pair.after.compared}",
                f"{pair.before.agree_pct:.1f}",
                f"{pair.after.agree_pct:.1f}",
                f"{pair.after.hidden_pct:.1f}",
                f"{pair.after.conflict_pct:.1f}",
            )
            for pair in pairs
        ],
        (0, 1),
    )


def _machine_table(found: MachineCalibration) -> Table:
    return Table(
        "Per camera: pixels of all poses, residuals, what its depth itself is off by",
        (
            "camera",
            "poses",
            "agree",
            "see through",
            "hidden",
            "rms [mm]",
            "median [mm]",
            "bias [mm]",
            "scale [%]",
            "poses disagree",
        ),
        [
            (
                row["camera"],
                str(row["poses"]),
                str(row["pixels"]),
                str(row["through"]),
                str(row["before"]),
                f"{row['rms_m'] * 1e3:.1f}",
                f"{row['median_m'] * 1e3:+.2f}",
                f"{row['bias_m'] * 1e3:+.1f}",
                f"{row['scale'] * 100:+.2f}",
                f"{np.sqrt(row['inflation']):.1f} x noise",
            )
            for row in found.rows
        ],
    )


def _notes(cameras: Sequence[Any]) -> Block:
    notes = [(note,) for one in cameras for note in one.notes]
    if not notes:
        return Words("Nothing is weak: no need to capture more.")
    return Table("What to capture next", ("what is weak, and what helps",), notes)


def _sigmas(covariance: NDArray[np.float64]) -> tuple[float, float]:
    return (
        float(np.sqrt(np.trace(covariance[3:, 3:]))),
        float(np.degrees(np.sqrt(np.trace(covariance[:3, :3])))),
    )


def _picture(one: SurfacePicture) -> Picture:
    """Three images side by side: measured, expected, difference."""
    there = one.expected_m > 0
    both = np.concatenate([one.measured_m[one.measured_m > 0], one.expected_m[there]])
    near, far = (float(v) for v in np.percentile(both, (1, 99))) if len(both) else (0.0, 1.0)
    parts = [depth_picture(image, near_m=near, far_m=far) for image in (one.measured_m, one.expected_m)]
    parts.append(Image.fromarray(difference_picture(one)))
    width, height = parts[0].size
    joined = Image.new("RGB", (3 * width + 8, height), (255, 255, 255))
    for number, part in enumerate(parts):
        joined.paste(part, (number * (width + 4), 0))
    buffer = io.BytesIO()
    joined.save(buffer, format="PNG", optimize=True)
    off = one.difference_m[one.agrees]
    rms = f"{np.sqrt(np.mean(off.astype(float) ** 2)) * 1e3:.1f} mm rms" if len(off) else "nothing agrees"
    return Picture(
        buffer.getvalue(),
        f"{one.camera}, {one.title}: measured, expected, and difference (blue: measured {SHOWN_M * 100:.0f} cm "
        f"nearer or more, red: farther, grey: nothing to compare); {rms} of the pixels that agree",
        PICTURE_WIDTH_PX,
    )


def difference_picture(one: SurfacePicture) -> NDArray[np.uint8]:
    """The difference as colours, shape (height, width, 3): blue is nearer, red farther, grey not compared."""
    difference = one.difference_m
    picture = np.empty((*difference.shape, 3), dtype=np.uint8)
    picture[:] = NOTHING
    known = np.isfinite(difference)
    place = np.clip(difference[known] / SHOWN_M, -1, 1)
    stops = np.array([NEARER, EXACT, FARTHER], dtype=float)
    picture[known] = np.stack(
        [np.interp(place, (-1, 0, 1), stops[:, channel]) for channel in range(3)], axis=-1
    ).round()
    return picture
