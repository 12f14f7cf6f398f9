"""The run of `elbowroom calibrate machine`."""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.calibrate.from_machine.target import MachineCalibration, calibrate_from_machine
from elbowroom.calibrate.pages.surface_report import machine_sections
from elbowroom.cli.calibrate.result import with_margins, write_page, write_result
from elbowroom.cli.calibrate.site import chosen_cameras, require_known, site_path
from elbowroom.cli.progress import Steps
from elbowroom.errors import CalibrationError, SiteError
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site
from elbowroom.site.calibration_entry import WorldFromCamera
from elbowroom.site.update import refuse_other_files
from elbowroom.sources import moments


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line says; see its help."""

    site: Path
    out: Path
    report: Path | None
    only: tuple[str, ...]
    base: bool
    hold: tuple[str, ...]
    model_mm: float
    confidence: float
    near_m: float | None


def run_machine(wanted: Wanted, json_file: Path | None) -> None:
    """Registers, writes the new site file and the page, prints what changed.

    Raises:
        CalibrationError: see `calibrate_from_machine`; no site file is written then.
        SiteError: a site without machine or recording, or a file in the way.
    """
    site = Site.load(site_path(wanted.site))
    refuse_other_files(site, wanted.out)
    machine = site.machine()
    if machine is None:
        raise SiteError(
            f"{site.path}: machine: missing; this command needs its URDF (or builtin: ceiling_c_arm)"
        )
    cameras = chosen_cameras(site, wanted.only)
    hold = _hold(site, wanted, cameras)
    begun = time.perf_counter()
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 3) as steps:
            found = calibrate_from_machine(
                machine,
                cameras,
                moments(site),
                hold=hold,
                free_base=wanted.base,
                model_sigma_m=wanted.model_mm / 1e3,
                progress=steps.begin_once,
            )
        for row in found.rows:
            add(row)
        add(_base_row(found, time.perf_counter() - begun))
        written = with_margins(
            site, found.cameras, wanted.confidence, found.depth_errors, near_m=wanted.near_m
        )
        base = None if found.base_covariance is None else found.machine.world_from_base
        rows = write_result(site, found.cameras, written, wanted.out, "machine", add, world_from_base=base)
        _say_base(found)
        if wanted.report is not None:
            about = f"{site.name}: cameras from the machine itself"
            write_page(wanted.report, "Calibration from the machine", about, machine_sections(found, rows))


def _hold(
    site: Site, wanted: Wanted, cameras: tuple[DepthCamera, ...]
) -> dict[str, NDArray[np.float64] | None]:
    """Cameras that fix the world when the base is to be found: named ones exactly, sure ones within covariance."""
    if not wanted.base:
        if wanted.hold:
            raise CalibrationError("--hold: goes with --base; without it the machine's base fixes the world")
        return {}
    known = {camera.name: site.pose_covariance(camera.name) for camera in cameras}
    hold = {name: covariance for name, covariance in known.items() if covariance is not None}
    named = list(wanted.hold)
    world = site.entry.calibration.world if site.entry.calibration is not None else None
    if isinstance(world, WorldFromCamera):
        named.append(world.camera)
    require_known("--hold", named, list(known))
    return {**hold, **dict.fromkeys(named)}


def _base_row(found: MachineCalibration, seconds: float) -> dict:
    return {
        "kind": "base",
        "machine": found.machine.name,
        "world_from_base": found.machine.world_from_base.tolist(),
        "covariance": None if found.base_covariance is None else found.base_covariance.tolist(),
        "poses": found.poses,
        "seconds": seconds,
    }


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
