"""The run of `elbowroom calibrate extrinsics`."""

from pathlib import Path

from elbowroom.cli.calibrate_options import site_path
from elbowroom.errors import SiteError
from elbowroom.site import Site


def run_extrinsics(
    given: Path,
    out: Path,
    report: Path | None,
    without_poses: tuple[int, ...],
    confidence: float,
    json_file: Path | None,
) -> None:
    """Detects, solves, writes the new site file and the page, prints what changed."""
    site = Site.load(site_path(given))
    raise SiteError(f"{site.path}: not yet")
