"""What every calibration ends with: the new site file, the table of changes, the page."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.result.beside_truth import beside_truth
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.change import change_rows, change_table
from elbowroom.calibrate.result.doubt import doubts_of
from elbowroom.calibrate.result.site_margin import with_margins
from elbowroom.cli.screen import show
from elbowroom.errors import NoResultError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.files.json_rows import AddRow, meta
from elbowroom.site import Site
from elbowroom.site.update import update_site
from elbowroom.view.report.blocks import Block
from elbowroom.view.report.page import page

PAGE = "report.html"
MORE = {
    "extrinsics": "more poses, nearer and tilted",
    "machine": "more poses, in which every joint moves in its view",
    "refine": "put furniture where it and others look, or calibrate it by a board first",
}
"""By command, what makes poses better known."""


@dataclass(frozen=True, slots=True)
class ResultOptions:
    """Where what was found goes, and with which margins.

    Args:
        out: the new site file.
        report: folder of the page; None: there is none.
        confidence: that nothing is displaced by more than a camera's margin.
        near_m: depth from which lateral margins hold [m]; None: as `pose_margin`.
        force_file: what is no result is written all the same, under another name.
    """

    out: Path
    report: Path | None
    confidence: float
    near_m: float | None
    force_file: bool = False


def write_result(
    site: Site,
    found: Sequence[CalibratedCamera],
    options: ResultOptions,
    command: str,
    add: AddRow,
    *,
    depth_errors: Mapping[str, tuple[float, float]] | None = None,
    world_from_base: NDArray[np.float64] | None = None,
) -> list[dict[str, Any]]:
    """Writes the new site file, adds a row for each camera, and prints the table of changes.

    Args:
        site: the old one.
        found: what was found.
        options: where to, and with which margins.
        command: as typed after `elbowroom calibrate`.
        add: takes rows.
        depth_errors: as of `with_margins`.
        world_from_base: where the machine was found to stand, shape (4, 4); None: as the site says.

    Returns:
        The rows.

    Raises:
        NoResultError: what was found is no result; the file, if it is forced, has another name.
    """
    cameras = with_margins(site, found, options.confidence, depth_errors, near_m=options.near_m)
    covariances = {one.camera.name: one.covariance for one in found}
    doubts = doubts_of(found, MORE.get(command, MORE["extrinsics"]))
    if not doubts:
        update_site(site, cameras, covariances, options.out, command, world_from_base)
    rows = change_rows(found, {camera.name: camera for camera in cameras})
    for row in rows:
        add(row)
    show(change_table(rows))
    say_weak([note for one in found for note in one.notes])
    if doubts:
        refuse(
            doubts,
            options.out,
            lambda aside: update_site(site, cameras, covariances, aside, command, world_from_base),
            force_file=options.force_file,
        )
    truth = beside_truth(found, site.path.parent)
    if truth is not None:
        print(f"truth     {truth}")
    print(f"site      {options.out}")
    print(f"next      elbowroom site check {options.out}")
    return rows


def refuse(doubts: Sequence[str], out: Path, write: Callable[[Path], Path], *, force_file: bool) -> NoReturn:
    """Says why what was found is no result; the file that was asked for is not written.

    Args:
        doubts: a sentence each.
        out: the file that was asked for.
        write: writes what was found into a file.
        force_file: whether it is written under another name, to be looked at.

    Raises:
        NoResultError: always.
    """
    aside = out.with_name(f"{out.stem}.doubted{out.suffix}")
    if force_file:
        write(aside)
        where = f"{out} was not written; what was found is in {aside}"
    else:
        where = f"{out} was not written (--force-file writes what was found to {aside.name}, to be looked at)"
    raise NoResultError(f"this is no result: {'; '.join(doubts)}; {where}")


def say_weak(notes: Sequence[str]) -> None:
    """Prints what is weak, and what to capture next."""
    for note in notes:
        print(f"weak      {note}")


def write_page(report: Path, title: str, about: str, sections: Sequence[tuple[str, Sequence[Block]]]) -> None:
    """Writes the page and says where it is.

    Args:
        report: its folder.
        title, about: of the page, and a paragraph below it.
        sections: title and blocks of each.
    """
    path = folder(report) / PAGE
    with whole_file(path) as unfinished:
        unfinished.write_text(page(title, about, sections, meta()), encoding="utf-8")
    print(f"page      {path}")
