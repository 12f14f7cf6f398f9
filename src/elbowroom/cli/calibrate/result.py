"""What every calibration ends with: margins, the new site file, the table of changes, the page."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.change import change_rows, change_table
from elbowroom.calibrate.result.margin import pose_margin
from elbowroom.files.atomic import folder, whole_file
from elbowroom.files.json_rows import AddRow, meta
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin
from elbowroom.site import Site
from elbowroom.site.update import update_site
from elbowroom.view.report.blocks import Block
from elbowroom.view.report.page import page
from elbowroom.view.report.tables import rich_table

PAGE = "report.html"


def with_margins(
    site: Site,
    found: Sequence[CalibratedCamera],
    confidence: float,
    depth_errors: Mapping[str, tuple[float, float]] | None = None,
    near_m: float | None = None,
) -> list[DepthCamera]:
    """The cameras with margins of sensor and pose together.

    Args:
        site: whose sensor margins they are.
        found: poses and covariances.
        confidence: that nothing is displaced by more.
        depth_errors: bias [m] and scale by which a camera's depth was found to read wrong; a site file has no place to
            take them out, so they are allowed for.
        near_m: depth from which lateral margins hold [m]; None: as `pose_margin`.
    """
    cameras = []
    listed = site.simulated is None or site.lists_cameras
    for one in found:
        name = one.camera.name
        sensor = site.sensor_margin(name) if listed else site.margin()
        bias, scale = (depth_errors or {}).get(name, (0.0, 0.0))
        sensor = replace(
            sensor,
            bias_m=max(sensor.bias_m, abs(bias)),
            range_linear=max(sensor.range_linear, abs(scale)),
        )
        margin: Margin = pose_margin(one.camera, one.covariance, confidence=confidence, near_m=near_m).over(
            sensor
        )
        cameras.append(replace(one.camera, margin=margin))
    return cameras


def write_result(
    site: Site,
    found: Sequence[CalibratedCamera],
    cameras: Sequence[DepthCamera],
    out: Path,
    command: str,
    add: AddRow,
    world_from_base: NDArray[np.float64] | None = None,
) -> list[dict[str, Any]]:
    """Writes the new site file, adds a row for each camera, and prints the table of changes.

    Args:
        site: the old one.
        found: what was found.
        cameras: as they are to be written, with margins.
        out: the new site file.
        command: as typed after `elbowroom calibrate`.
        add: takes rows.
        world_from_base: where the machine was found to stand, shape (4, 4); None: as the site says.

    Returns:
        The rows.
    """
    update_site(
        site, cameras, {one.camera.name: one.covariance for one in found}, out, command, world_from_base
    )
    rows = change_rows(found, {camera.name: camera for camera in cameras})
    for row in rows:
        add(row)
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 140
    console.print(rich_table(change_table(rows)))
    for one in found:
        for note in one.notes:
            console.print(f"weak      {note}", soft_wrap=True)
    print(f"site      {out}")
    return rows


def write_page(report: Path, title: str, about: str, sections: Sequence[tuple[str, Sequence[Block]]]) -> None:
    """Writes the page into its folder and says where it is."""
    path = folder(report) / PAGE
    with whole_file(path) as unfinished:
        unfinished.write_text(page(title, about, sections, meta()), encoding="utf-8")
    print(f"page      {path}")
