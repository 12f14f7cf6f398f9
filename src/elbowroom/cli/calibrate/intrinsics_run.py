"""The run of `elbowroom calibrate intrinsics`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from elbowroom.calibrate.boards.capture import Sightings, sightings
from elbowroom.calibrate.intrinsics import FoundIntrinsics, cells_seen, solve_intrinsics
from elbowroom.calibrate.pages.intrinsics import report_sections
from elbowroom.cli.calibrate.images import PoseImages
from elbowroom.cli.calibrate.result import write_page
from elbowroom.cli.calibrate.site import site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site
from elbowroom.site.update import lens_entry, refuse_other_files, update_lenses

SIGNIFICANT = 2.0
"""Scale and bias of depth are written where one of them is off by so many sigmas."""


def run_intrinsics(
    given: Path,
    out: Path,
    report: Path | None,
    names: Sequence[str],
    coefficients: int,
    json_file: Path | None,
) -> None:
    """Detects, solves camera by camera, writes the new site file and the page, prints what was found.

    Raises:
        CalibrationError: a camera whose intrinsics cannot be had from this capture; no file is written.
        SiteError, FrameError: a site or images that cannot be used.
    """
    site = Site.load(site_path(given))
    refuse_other_files(site, out)
    cameras = _chosen(site, names)
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 2) as steps:
            steps.begin("looking for the board in all images")
            seen = sightings(site)
            steps.begin("solving camera by camera")
            found = [_solved(site, camera, seen, coefficients) for camera in cameras]
        update_lenses(site, {one.camera.name: _entry(site, one) for one in found}, out, "intrinsics")
        for one in found:
            add(intrinsics_row(one))
        add(_summary(site, seen, steps.seconds))
    _show(found)
    print(f"views     {len(seen.views)} of {len(seen.views) + len(seen.troubles)} images")
    print(f"site      {out}")
    if report is not None:
        write_page(
            report,
            f"Intrinsics of {site.name}",
            "How the cameras see, from a board that each of them saw.",
            report_sections(
                found,
                seen.board.corners_in_board,
                [str(trouble) for trouble in seen.troubles],
                PoseImages(site).grey,
            ),
        )


def _chosen(site: Site, names: Sequence[str]) -> list[DepthCamera]:
    known = {camera.name: camera for camera in site.cameras()}
    unknown = [name for name in names if name not in known]
    if unknown:
        raise CalibrationError(f"--camera {unknown[0]}: unknown; cameras are {', '.join(known)}")
    return [known[name] for name in names] if names else list(known.values())


def _solved(site: Site, camera: DepthCamera, seen: Sightings, coefficients: int) -> FoundIntrinsics:
    """One camera; an error also says what its other images showed."""
    entry = site.entry.calibration
    least = 3 if entry is None else entry.least_views
    try:
        return solve_intrinsics(camera, seen.board, seen.views, coefficients, least)
    except CalibrationError as error:
        why = [str(trouble) for trouble in seen.troubles if trouble.camera == camera.name]
        if not why:
            raise
        raise CalibrationError(f"{error} (of its images {len(why)} show no whole board: {why[0]})") from None


def _entry(site: Site, one: FoundIntrinsics) -> dict[str, Any]:
    """The keys of the site file that change: measured = scale * true + bias, solved for what is true."""
    entry = lens_entry(one.camera.intrinsics)
    off = np.abs([one.depth_scale - 1, one.depth_bias_m]) > SIGNIFICANT * np.array(one.depth_sigma)
    if off.any():
        name = one.camera.name
        entry["depth_scale_m"] = float(f"{site.depth_scale_m(name) / one.depth_scale:.8g}")
        bias = (site.depth_bias_m(name) - one.depth_bias_m) / one.depth_scale
        entry["depth_bias_m"] = round(bias, 6)
    return entry


def intrinsics_row(one: FoundIntrinsics) -> dict[str, Any]:
    """A row of kind "intrinsics"."""
    k, before = one.camera.intrinsics, one.before.intrinsics
    return {
        "kind": "intrinsics",
        "camera": one.camera.name,
        **{name: getattr(k, name) for name in ("fx", "fy", "cx", "cy")},
        "distortion": list(k.distortion),
        "sigma": one.sigma,
        "fx_before": before.fx,
        "fy_before": before.fy,
        "depth_scale": one.depth_scale,
        "depth_bias_m": one.depth_bias_m,
        "depth_sigma": list(one.depth_sigma),
        "residual_px": float(np.sqrt(np.mean(one.residuals_px**2))),
        "residual_m": float(np.sqrt(np.mean(one.residuals_m**2))) if len(one.residuals_m) else None,
        "views": len(one.views),
        "corners_by_ninth": cells_seen(one.camera, one.views),
        "notes": list(one.notes),
    }


def _summary(site: Site, seen: Sightings, seconds: dict[str, float]) -> dict[str, Any]:
    return {
        "kind": "capture",
        "site": str(site.path),
        "poses": seen.poses,
        "views": len(seen.views),
        "troubles": [str(trouble) for trouble in seen.troubles],
        "seconds": seconds,
    }


def _show(found: Sequence[FoundIntrinsics]) -> None:
    table = Table(
        box=None, pad_edge=False, title="Intrinsics: what was found, and one sigma", title_justify="left"
    )
    for column in (
        "camera",
        "views",
        "fx",
        "fy",
        "cx",
        "cy",
        "distortion",
        "depth scale",
        "depth bias",
        "corners",
    ):
        table.add_column(column, justify="left" if column == "camera" else "right", no_wrap=True)
    for one in found:
        k, s = one.camera.intrinsics, one.sigma
        table.add_row(
            one.camera.name,
            str(len(one.views)),
            *(
                f"{getattr(k, name):.2f} ±{sigma:.2f}"
                for name, sigma in zip(("fx", "fy", "cx", "cy"), s[:4], strict=True)
            ),
            str(len(k.distortion)),
            f"{one.depth_scale:.4f} ±{one.depth_sigma[0]:.4f}",
            f"{1e3 * one.depth_bias_m:.1f} ±{1e3 * one.depth_sigma[1]:.1f} mm",
            f"{float(np.sqrt(np.mean(one.residuals_px**2))):.2f} px",
        )
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 140
    console.print(table)
    for one in found:
        for note in one.notes:
            console.print(f"weak      {note}", soft_wrap=True)
