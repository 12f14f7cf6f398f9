"""The run of `elbowroom calibrate extrinsics`."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.calibrate.boards.capture import Sightings, images_of, instead_of, sightings
from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.calibrate.extrinsics.solve import Extrinsics, solve_extrinsics
from elbowroom.calibrate.pages.board_report import rms
from elbowroom.calibrate.pages.extrinsics import report_sections
from elbowroom.cli.calibrate.images import PoseImages
from elbowroom.cli.calibrate.result import ResultOptions, write_page, write_result
from elbowroom.cli.calibrate.site import site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.site import Site
from elbowroom.site.update import refuse_other_files


@dataclass(frozen=True, slots=True)
class ExtrinsicsOptions:
    """What the command line says; see its help."""

    site: Path
    without_poses: tuple[int, ...]
    result: ResultOptions


def run_extrinsics(options: ExtrinsicsOptions, json_file: Path | None) -> None:
    """Detects, solves, writes the new site file and the page, prints what changed.

    Raises:
        CalibrationError: see `solve_extrinsics`, or a pose to be left out that is not there; no file is written.
        SiteError, FrameError: a site or images that cannot be used.
    """
    site = Site.load(site_path(options.site))
    refuse_other_files(site, options.result.out)
    anchor = anchor_of(site)
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 4) as steps:
            steps.begin("looking for the board in all images")
            seen = sightings(site, steps.counted)
            found = _solved(site, seen, anchor, options.without_poses, steps.begin)
        rows = write_result(
            site, found.cameras, options.result, "extrinsics", add, depth_errors=found.depth_errors()
        )
        troubles = [str(trouble) for trouble in (*seen.troubles, *found.left_out)]
        add(_capture_row(site, found, troubles, steps.seconds))
    _say(found, len(troubles))
    if options.result.report is not None:
        sections = report_sections(found, rows, troubles, PoseImages(site).grey)
        about = "Where the cameras are, from a board that they saw."
        write_page(options.result.report, f"Extrinsics of {site.name}", about, sections)


def _solved(
    site: Site, seen: Sightings, anchor: Any, without: Sequence[int], progress: Callable[[str], None]
) -> Extrinsics:
    """Extrinsics from what the capture shows; an error also says what to type, and what the images showed."""
    unknown = [pose for pose in without if not 0 <= pose < seen.poses]
    if unknown:
        raise CalibrationError(f"--without-pose {unknown[0]}: poses are 0 to {seen.poses - 1}")
    entry = site.entry.calibration
    views = [view for view in seen.views if view.pose not in without]
    least = 1 if entry is None else entry.least_views
    try:
        return solve_extrinsics(
            site.cameras(), seen.board, views, anchor, least_views=least, progress=progress
        )
    except CalibrationError as error:
        raise CalibrationError(told(str(error), seen, lambda names: closer(site, seen, names))) from None


def closer(site: Site, seen: Sightings, names: Sequence[str]) -> str | None:
    """What images of some cameras show instead of the board; None: nothing that can be told.

    Args:
        site: whose images they are.
        seen: what was looked for.
        names: of the cameras.
    """
    others = [camera.name for camera in site.cameras() if camera.name not in names]
    return instead_of(
        site,
        seen.board,
        images_of(site, names),
        others_see_it=seen.is_seen_by(others),
        seen_share=seen.share_seen_by(names),
    )


def told(
    error: str, seen: Sightings, closer: Callable[[Sequence[str]], str | None] = lambda names: None
) -> str:
    """What was wrong, with the option that leaves a bad pose out and with what the images of a bad camera showed.

    Args:
        error: as `solve_extrinsics` says it.
        seen: what it was given.
        closer: looks what the images of some cameras show instead of the board.
    """
    pose = re.match(r"pose (\d+).* do not agree where the board was", error)
    if pose is not None:
        error += f" (--without-pose {pose[1]})"
    why = [
        trouble
        for trouble in seen.troubles
        if any(f" {trouble.camera}{end}" in error for end in (" ", ";", ","))
    ]
    if not why or pose is not None:
        return error
    unseen = "never seen" in error or "share no pose" in error or "too few poses" in error
    instead = closer(sorted({trouble.camera for trouble in why})) if unseen else None
    if instead is not None:
        return f"{instead} ({error})"
    return f"{error} (of {len(why)} images without a view: {why[0]})"


def _capture_row(
    site: Site, found: Extrinsics, troubles: Sequence[str], seconds: Mapping[str, float]
) -> dict[str, Any]:
    """The row of kind "capture"."""
    return {
        "kind": "capture",
        "site": str(site.path),
        **found.row(),
        "images_without_view": len(troubles),
        "troubles": troubles,
        "seconds": seconds,
    }


def _say(found: Extrinsics, without_view: int) -> None:
    print(
        f"views     {len(found.seen)} of {len(found.seen) + without_view} images, "
        f"{len(found.world_from_board)} poses of the board"
    )
    for trouble in found.left_out:
        print(f"left out  {trouble}")
    for name in found.points_unseen:
        print(f"left out  point {name}: no camera saw the board in its pose")
    if found.points_off_m:
        off_m = np.array(list(found.points_off_m.values()))
        print(
            f"world     {len(off_m)} measured points, {rms(off_m) * 1e3:.1f} mm rms from where they are seen, "
            f"{off_m.max() * 1e3:.1f} mm at most"
        )
