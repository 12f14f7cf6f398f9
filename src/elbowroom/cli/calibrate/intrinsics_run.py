"""The run of `elbowroom calibrate intrinsics`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from elbowroom.calibrate.boards.capture import Sightings, images_of, instead_of, sightings
from elbowroom.calibrate.intrinsics import FoundIntrinsics, solve_intrinsics
from elbowroom.calibrate.intrinsics.doubt import doubts_of_lens
from elbowroom.calibrate.intrinsics.site_keys import changed_keys
from elbowroom.calibrate.pages.intrinsics import lens_table, report_sections
from elbowroom.cli.calibrate.images import PoseImages
from elbowroom.cli.calibrate.result import refuse, say_weak, write_page
from elbowroom.cli.calibrate.site import chosen_cameras, site_path
from elbowroom.cli.progress import Steps
from elbowroom.cli.screen import show
from elbowroom.errors import CalibrationError
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site
from elbowroom.site.update import refuse_other_files, update_lenses


@dataclass(frozen=True, slots=True)
class IntrinsicsOptions:
    """What the command line says; see its help."""

    site: Path
    out: Path
    report: Path | None
    only: tuple[str, ...]
    coefficients: int
    force_file: bool = False


def run_intrinsics(options: IntrinsicsOptions, json_file: Path | None) -> None:
    """Detects, solves camera by camera, writes the new site file and the page, prints what was found.

    Raises:
        CalibrationError: a camera whose intrinsics cannot be had from this capture; no file is written.
        SiteError, FrameError: a site or images that cannot be used.
    """
    site = Site.load(site_path(options.site))
    refuse_other_files(site, options.out)
    cameras = chosen_cameras(site, options.only)
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 2) as steps:
            steps.begin("looking for the board in all images")
            seen = sightings(site, steps.counted)
            steps.begin("solving camera by camera")
            found = [_solved(site, camera, seen, options.coefficients) for camera in cameras]
        lenses = {one.camera.name: changed_keys(site, one) for one in found}
        doubts = doubts_of_lens(found)
        if not doubts:
            update_lenses(site, lenses, options.out, "intrinsics")
        for one in found:
            add(one.row())
        add({"kind": "capture", "site": str(site.path), **seen.row(), "seconds": steps.seconds})
    show(lens_table(found))
    say_weak([note for one in found for note in one.notes])
    print(f"views     {len(seen.views)} of {len(seen.views) + len(seen.troubles)} images")
    if doubts:
        refuse(
            doubts,
            options.out,
            lambda aside: update_lenses(site, lenses, aside, "intrinsics"),
            force_file=options.force_file,
        )
    print(f"site      {options.out}")
    print(f"next      elbowroom calibrate extrinsics {options.out} --out calibrated.yaml")
    if options.report is not None:
        _write_page(options.report, site, found, seen)


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
        others = [one.name for one in site.cameras() if one.name != camera.name]
        work = images_of(site, [camera.name])
        share = seen.share_seen_by([camera.name])
        closer = instead_of(site, seen.board, work, others_see_it=seen.is_seen_by(others), seen_share=share)
        raise CalibrationError(
            f"{error} (of its images {len(why)} show no whole board: {closer or why[0]})"
        ) from None


def _write_page(report: Path, site: Site, found: Sequence[FoundIntrinsics], seen: Sightings) -> None:
    troubles = [str(trouble) for trouble in seen.troubles]
    sections = report_sections(found, seen.board.corners_in_board, troubles, PoseImages(site).grey)
    about = "How the cameras see, from a board that each of them saw."
    write_page(report, f"Intrinsics of {site.name}", about, sections)
