"""The run of `elbowroom calibrate refine`."""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.calibrate.pages.surface_report import pair_table, refine_sections
from elbowroom.calibrate.refinement.refine import Refinement, refine
from elbowroom.cli.calibrate.result import with_margins, write_page, write_result
from elbowroom.cli.calibrate.site import chosen_cameras, require_known, site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site
from elbowroom.site.update import refuse_other_files
from elbowroom.sources import moments
from elbowroom.view.report.tables import rich_table


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line says; see its help."""

    site: Path
    out: Path
    report: Path | None
    only: tuple[str, ...]
    hold: tuple[str, ...]
    sure_to: str | None
    confidence: float
    near_m: float | None


def run_refine(wanted: Wanted, json_file: Path | None) -> None:
    """Refines, writes the new site file and the page, prints what changed.

    Raises:
        CalibrationError: see `refine`; no site file is written then.
        SiteError: a site without recording, or a file in the way.
        InputError: `--sure-to` that is not two numbers.
    """
    site = Site.load(site_path(wanted.site))
    refuse_other_files(site, wanted.out)
    cameras = chosen_cameras(site, wanted.only)
    covariances = _covariances(site, wanted, cameras)
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 3) as steps:
            # where the machine was does not matter here
            found = refine(cameras, covariances, moments(site, joints={}), progress=steps.begin_once)
        for row in pair_rows(found):
            add(row | {"seconds": time.perf_counter() - begun})
        written = with_margins(site, found.cameras, wanted.confidence, near_m=wanted.near_m)
        rows = write_result(site, found.cameras, written, wanted.out, "refine", add)
        Console(highlight=False).print(rich_table(pair_table(found)))
        if wanted.report is not None:
            about = f"{site.name}: cameras refined on what they see in common"
            write_page(wanted.report, "Refinement", about, refine_sections(found, rows))


def pair_rows(found: Refinement) -> list[dict]:
    """A row of kind "pair" for each two cameras: shares of pixels that agree before and after [%]."""
    return [
        {
            "kind": "pair",
            "one": pair.one,
            "other": pair.other,
            "compared": pair.after.compared,
            "agree_before_pct": pair.before.agree_pct,
            "agree_pct": pair.after.agree_pct,
            "hidden_pct": pair.after.hidden_pct,
            "conflict_pct": pair.after.conflict_pct,
        }
        for pair in found.pairs
    ]


def _covariances(
    site: Site, wanted: Wanted, cameras: tuple[DepthCamera, ...]
) -> dict[str, NDArray[np.float64] | None]:
    """By camera: None holds exactly; what the site says; or what the command line says."""
    names = [camera.name for camera in cameras]
    require_known("--hold", wanted.hold, names)
    usual = _sure_to(wanted.sure_to)
    found: dict[str, NDArray[np.float64] | None] = {}
    for name in names:
        known = site.pose_covariance(name)
        if name in wanted.hold:
            found[name] = None
        elif known is not None:
            found[name] = known
        elif usual is not None:
            found[name] = usual
    return found


def _sure_to(text: str | None) -> NDArray[np.float64] | None:
    """Covariance of a pose from "50,3": mm and degrees along and about each axis."""
    if text is None:
        return None
    try:
        place_mm, turn_deg = (float(word) for word in text.split(","))
    except ValueError:
        place_mm = turn_deg = float("nan")
    if not (np.isfinite(place_mm) and np.isfinite(turn_deg) and place_mm > 0 and turn_deg > 0):
        raise InputError(
            f"--sure-to: {text!r} is not two numbers above 0; write mm and degrees, such as 50,3"
        )
    return np.diag([np.radians(turn_deg) ** 2] * 3 + [(place_mm / 1e3) ** 2] * 3)
