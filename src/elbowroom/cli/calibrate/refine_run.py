"""The run of `elbowroom calibrate refine`."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.calibrate.pages.surface_report import pair_table, refine_sections
from elbowroom.calibrate.refinement.refine import refine
from elbowroom.cli.calibrate.result import ResultOptions, write_page, write_result
from elbowroom.cli.calibrate.site import chosen_cameras, require_known, site_path
from elbowroom.cli.progress import Steps
from elbowroom.cli.screen import show
from elbowroom.errors import CalibrationError, InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.site import Site
from elbowroom.site.update import refuse_other_files
from elbowroom.sources import moments

SHOWN_PAIRS = 12
"""On the terminal; the page and the rows have all."""


@dataclass(frozen=True, slots=True)
class RefineOptions:
    """What the command line says; see its help."""

    site: Path
    only: tuple[str, ...]
    hold: tuple[str, ...]
    sure_to: str | None
    result: ResultOptions


def run_refine(options: RefineOptions, json_file: Path | None) -> None:
    """Refines, writes the new site file and the page, prints what changed.

    Raises:
        CalibrationError: see `refine`; no site file is written then.
        SiteError: a site without recording, or a file in the way.
        InputError: `--sure-to` that is not two numbers.
    """
    site = Site.load(site_path(options.site))
    refuse_other_files(site, options.result.out)
    cameras = chosen_cameras(site, options.only)
    covariances = pose_covariances(site, options, [camera.name for camera in cameras])
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 3) as steps:
            # where the machine was does not matter here
            found = refine(cameras, covariances, moments(site, joints={}), progress=steps.begin_once)
        for pair in found.pairs:
            add(pair.row() | {"seconds": time.perf_counter() - begun})
        rows = write_result(site, found.cameras, options.result, "refine", add)
        show(pair_table(found, worst=SHOWN_PAIRS))
        if options.result.report is not None:
            about = f"{site.name}: cameras refined on what they see in common"
            write_page(options.result.report, "Refinement", about, refine_sections(found, rows))


def pose_covariances(
    site: Site, options: RefineOptions, cameras: Sequence[str]
) -> dict[str, NDArray[np.float64] | None]:
    """By camera: None where it holds exactly; what the site says; or what the command line says.

    Args:
        site: may say how sure poses are.
        options: may name cameras that hold, and say how sure the others are.
        cameras: names of those that are refined.

    Raises:
        SiteError: a name of no camera.
        InputError: `--sure-to` that is not two numbers.
        CalibrationError: a camera of which nothing is said.
    """
    require_known("--hold", options.hold, cameras)
    usual = _sure_to(options.sure_to)
    found: dict[str, NDArray[np.float64] | None] = dict.fromkeys(options.hold)
    for name in cameras:
        if name in found:
            continue
        known = site.pose_covariance(name)
        found[name] = usual if known is None else known
        if found[name] is None:
            raise CalibrationError(
                f"camera {name}: how sure its pose is, is not known; calibrate it by a board or the machine, or say it "
                "with --sure-to"
            )
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
