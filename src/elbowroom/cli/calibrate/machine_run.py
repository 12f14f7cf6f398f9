"""The run of `elbowroom calibrate machine`."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.calibrate.from_machine.target import MachineCalibration, calibrate_from_machine
from elbowroom.calibrate.pages.surface_report import machine_sections
from elbowroom.cli.calibrate.result import ResultOptions, write_page, write_result
from elbowroom.cli.calibrate.site import chosen_cameras, require_known, site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import CalibrationError, MachineError, SiteError
from elbowroom.files.json_rows import AddRow, json_rows
from elbowroom.site import Site
from elbowroom.site.calibration_entry import WorldFromCamera
from elbowroom.site.update import refuse_other_files
from elbowroom.sources import moments


@dataclass(frozen=True, slots=True)
class MachineOptions:
    """What the command line says; see its help."""

    site: Path
    only: tuple[str, ...]
    base: bool
    hold: tuple[str, ...]
    model_mm: float
    result: ResultOptions


def run_machine(options: MachineOptions, json_file: Path | None) -> None:
    """Registers, writes the new site file and the page, prints what changed.

    Raises:
        CalibrationError: see `calibrate_from_machine`; no site file is written then.
        SiteError: a site without machine or recording, or a file in the way.
    """
    site = Site.load(site_path(options.site))
    refuse_other_files(site, options.result.out)
    machine = site.machine()
    if machine is None:
        raise SiteError(
            f"{site.path}: machine: missing; this command needs its URDF (or builtin: ceiling_c_arm)"
        )
    cameras = chosen_cameras(site, options.only)
    hold = held(site, options, [camera.name for camera in cameras])
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 3) as steps:
            try:
                found = calibrate_from_machine(
                    machine,
                    cameras,
                    moments(site),
                    hold=hold,
                    free_base=options.base,
                    model_sigma_m=options.model_mm / 1e3,
                    progress=steps.begin_once,
                )
            except MachineError as error:
                raise MachineError(
                    f"{error}; joints are recorded in radians and metres: are these degrees?"
                ) from None
        for row in found.rows:
            add(row)
        add(found.row() | {"seconds": time.perf_counter() - begun})
        _write(site, found, options.result, add)


def _write(site: Site, found: MachineCalibration, options: ResultOptions, add: AddRow) -> None:
    base = None if found.base_covariance is None else found.machine.world_from_base
    rows = write_result(
        site,
        found.cameras,
        options,
        "machine",
        add,
        depth_errors=found.depth_errors,
        world_from_base=base,
    )
    _say_base(found)
    if options.report is not None:
        about = f"{site.name}: cameras from the machine itself"
        write_page(options.report, "Calibration from the machine", about, machine_sections(found, rows))


def held(
    site: Site, options: MachineOptions, cameras: Sequence[str]
) -> dict[str, NDArray[np.float64] | None]:
    """Cameras that fix the world when the base is to be found: named ones exactly, sure ones within covariance.

    Args:
        site: may say how sure poses are, and which camera fixes the world.
        options: may name cameras that hold.
        cameras: names of those that are calibrated.

    Raises:
        CalibrationError: named without need, or none where one is needed.
        SiteError: a name of no camera.
    """
    if not options.base:
        if options.hold:
            raise CalibrationError("--hold: goes with --base; without it the machine's base fixes the world")
        return {}
    known = {name: site.pose_covariance(name) for name in cameras}
    hold = {name: covariance for name, covariance in known.items() if covariance is not None}
    named = list(options.hold)
    world = site.entry.calibration.world if site.entry.calibration is not None else None
    if isinstance(world, WorldFromCamera):
        named.append(world.camera)
    require_known("--hold", named, cameras)
    if not hold and not named:
        raise CalibrationError(
            "the machine's base and all cameras at once: nothing fixes the world; name cameras whose poses hold with "
            "--hold, or find the cameras by a board first"
        )
    return {**hold, **dict.fromkeys(named)}


def _say_base(found: MachineCalibration) -> None:
    x, y, z = found.machine.world_from_base[:3, 3]
    if found.base_covariance is None:
        print(
            f"base      {found.machine.name} at ({x:.4f}, {y:.4f}, {z:.4f}) m, as the site says: it fixes the world"
        )
        return
    sigma_mm = 1e3 * np.sqrt(np.trace(found.base_covariance[3:, 3:]))
    sigma_deg = np.degrees(np.sqrt(np.trace(found.base_covariance[:3, :3])))
    print(
        f"base      {found.machine.name} at ({x:.4f}, {y:.4f}, {z:.4f}) m, sure to {sigma_mm:.2f} mm and "
        f"{sigma_deg:.3f} degrees"
    )
