"""The run of `elbowroom calibrate extrinsics`."""

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.calibrate.boards.capture import Sightings, sightings
from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.calibrate.extrinsics.solve import Extrinsics, solve_extrinsics
from elbowroom.calibrate.pages.board_report import rms
from elbowroom.calibrate.pages.extrinsics import report_sections
from elbowroom.cli.calibrate.images import PoseImages
from elbowroom.cli.calibrate.result import with_margins, write_page, write_result
from elbowroom.cli.calibrate.site import site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.site import Site
from elbowroom.site.update import refuse_other_files

SHOWN_TROUBLES = 5


def run_extrinsics(
    given: Path,
    out: Path,
    report: Path | None,
    without_poses: tuple[int, ...],
    confidence: float,
    near_m: float | None,
    json_file: Path | None,
) -> None:
    """Detects, solves, writes the new site file and the page, prints what changed."""
    site = Site.load(site_path(given))
    refuse_other_files(site, out)
    anchor = anchor_of(site)
    with json_rows(json_file) as add:
        console = Console(stderr=True)
        with Steps(console, 4) as steps:
            steps.begin("looking for the board in all images")
            seen = sightings(site)
            found = solve(site, seen, anchor, without_poses, steps)
        cameras = with_margins(
            site,
            found.cameras,
            confidence,
            found.depth_errors(),
            near_m=near_m,
        )
        rows = write_result(site, found.cameras, cameras, out, "extrinsics", add)
        add(summary_row(site, found, seen, steps.seconds))
    troubles = [str(trouble) for trouble in (*seen.troubles, *found.left_out)]
    print(
        f"views     {len(found.seen)} of {len(found.seen) + len(troubles)} images, "
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
    if report is not None:
        images = PoseImages(site)
        sections = report_sections(found, rows, troubles, images.grey)
        write_page(
            report,
            f"Extrinsics of {site.name}",
            "Where the cameras are, from a board that they saw.",
            sections,
        )


def solve(
    site: Site, seen: Sightings, anchor: Any, without_poses: tuple[int, ...], steps: Steps | None = None
) -> Extrinsics:
    """Extrinsics from what the capture shows.

    Raises:
        CalibrationError: a pose to be left out that is not there, or as `solve_extrinsics`.
    """
    unknown = [pose for pose in without_poses if not 0 <= pose < seen.poses]
    if unknown:
        raise CalibrationError(f"--without-pose {unknown[0]}: poses are 0 to {seen.poses - 1}")
    entry = site.entry.calibration
    try:
        return solve_extrinsics(
            site.cameras(),
            seen.board,
            [view for view in seen.views if view.pose not in without_poses],
            anchor,
            least_views=1 if entry is None else entry.least_views,
            progress=steps.begin if steps else lambda text: None,
        )
    except CalibrationError as error:
        why = [
            str(t)
            for t in seen.troubles
            if any(name in str(error) for name in (f" {t.camera} ", f" {t.camera};"))
        ]
        if not why:
            raise
        raise CalibrationError(f"{error} (of {len(why)} images without a view: {why[0]})") from None


def summary_row(site: Site, found: Extrinsics, seen: Sightings, seconds: dict[str, float]) -> dict[str, Any]:
    """The row of kind "capture"."""
    return {
        "kind": "capture",
        "site": str(site.path),
        "cameras": len(found.cameras),
        "poses": len(found.world_from_board),
        "views": len(found.seen),
        "images_without_view": len(seen.troubles) + len(found.left_out),
        "troubles": [str(trouble) for trouble in (*seen.troubles, *found.left_out)],
        "points_unseen": list(found.points_unseen),
        "points_off_m": dict(found.points_off_m),
        "seconds": seconds,
    }
