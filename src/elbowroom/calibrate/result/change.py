"""What a calibration changed, camera by camera."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.view.report.blocks import Table


def pose_difference(
    world_from_one: NDArray[np.float64], world_from_other: NDArray[np.float64]
) -> tuple[float, float]:
    """How far two poses lie apart: distance of their origins [m] and angle between them [rad]."""
    one_from_other = invert_rigid(world_from_one) @ world_from_other
    sine = np.linalg.norm(
        [
            one_from_other[2, 1] - one_from_other[1, 2],
            one_from_other[0, 2] - one_from_other[2, 0],
            one_from_other[1, 0] - one_from_other[0, 1],
        ]
    )
    angle = np.arctan2(sine, np.trace(one_from_other[:3, :3]) - 1)
    return float(np.linalg.norm(one_from_other[:3, 3])), float(angle)


def change_rows(
    found: Sequence[CalibratedCamera], cameras: Mapping[str, DepthCamera]
) -> list[dict[str, Any]]:
    """A row of kind "camera" for each: what moved, how sure its pose is, residuals, the margin.

    Args:
        found: what calibration found.
        cameras: the same cameras by name, as they are written, with their margins.
    """
    rows = []
    for one in found:
        camera, k = cameras[one.camera.name], one.camera.intrinsics
        moved, turned = (
            (None, None)
            if one.before is None
            else pose_difference(one.before.world_from_camera, camera.world_from_camera)
        )
        rows.append(
            {
                "kind": "camera",
                "camera": camera.name,
                "moved_m": moved,
                "turned_deg": None if turned is None else float(np.degrees(turned)),
                "fx": k.fx,
                "fx_before": None if one.before is None else one.before.intrinsics.fx,
                "sigma_m": float(np.sqrt(np.trace(one.covariance[3:, 3:]))),
                "sigma_deg": float(np.degrees(np.sqrt(np.trace(one.covariance[:3, :3])))),
                "residual_px": _rms(one.residuals_px),
                "residual_m": _rms(one.residuals_m),
                "lateral_px": None if camera.margin is None else camera.margin.lateral_px,
                "bias_m": None if camera.margin is None else camera.margin.bias_m,
                "range_linear": None if camera.margin is None else camera.margin.range_linear,
                "notes": list(one.notes),
            }
        )
    return rows


def change_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """The same for people: mm and degrees."""
    return Table(
        "Cameras: what changed, how sure it is (one sigma), what is left over, and the margin that is written",
        (
            "camera",
            "moved",
            "turned",
            "fx",
            "sure to",
            "and to",
            "corners",
            "depth",
            "lateral",
            "bias",
            "per metre",
        ),
        [
            (
                row["camera"],
                _or_new(row["moved_m"], 1e3, "mm", 1),
                _or_new(row["turned_deg"], 1, "deg", 3),
                f"{row['fx']:.1f}"
                + (
                    ""
                    if row["fx_before"] in (None, row["fx"])
                    else f" ({100 * (row['fx'] / row['fx_before'] - 1):+.2f} %)"
                ),
                f"{row['sigma_m'] * 1e3:.2f} mm",
                f"{row['sigma_deg']:.4f} deg",
                _or_none(row["residual_px"], 1, "px", 2),
                _or_none(row["residual_m"], 1e3, "mm", 1),
                _or_none(row["lateral_px"], 1, "px", 2),
                _or_none(row["bias_m"], 1e3, "mm", 1),
                _or_none(row["range_linear"], 1e3, "mm", 2),
            )
            for row in rows
        ],
    )


def _or_new(value: float | None, scale: float, unit: str, digits: int) -> str:
    return "new" if value is None else f"{value * scale:.{digits}f} {unit}"


def _or_none(value: float | None, scale: float, unit: str, digits: int) -> str:
    return "-" if value is None else f"{value * scale:.{digits}f} {unit}"


def _rms(values: NDArray[np.float64]) -> float | None:
    return float(np.sqrt(np.mean(values**2))) if len(values) else None
