"""The run of `elbowroom placement verify`."""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.placement.options import VerifyOptions
from elbowroom.cli.placement.room import room_of
from elbowroom.cli.progress import Steps
from elbowroom.cli.swept import say_swept, swept_row
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.pictures import save_pictures
from elbowroom.placement.requirement import requirement_of
from elbowroom.placement.swept.picture import save_swept
from elbowroom.placement.verification import Verification, verify
from elbowroom.placement.worst import worst_places
from elbowroom.site import Site
from elbowroom.sources import cameras_of

NO_WALLS = "the site has no key room: nothing blocks sight, and every pixel is taken to have a return"


def run_verify(options: VerifyOptions, json_file: Path | None) -> None:
    """Verifies the cameras of a site and prints what they see.

    Raises:
        InputError: a site, cameras or a requirement that cannot be; a folder that cannot be written to.
    """
    site = Site.load(options.site)
    requirement = requirement_of(site, options.required.views, options.required.angle_deg)
    cameras, room, grid = cameras_of(site), room_of(site), site.grid(options.voxel_size_m)
    with json_rows(json_file) as add:
        with Steps(Console(stderr=True), 2) as steps:
            steps.begin("readying kernels, which are compiled at the first start")
            verify(_two_cells(site, grid), cameras[:1], None, requirement)
            steps.begin(f"looking through {len(cameras)} cameras")
            begun = time.perf_counter()
            found = verify(grid, cameras, room, requirement)
            seconds = time.perf_counter() - begun
        row = verified_row(found, options.worst) | {"site": str(site.path), "name": site.name}
        row |= {"seconds": seconds, "walls_known": room is not None}
        swept, of_swept = swept_row(site)
        row |= of_swept
        files = [] if options.out is None else save_pictures(found, room, options.out, site.name)
        if swept is not None and options.out is not None:
            files += save_swept(swept, found.cameras, room, options.out, site.name)
        add(row | {"files": [str(path) for path in files]})
    say_verification(row)
    say_swept(row)
    say_files(files, walls_known=room is not None)


def verified_row(found: Verification, worst: int = 5) -> dict[str, Any]:
    """A row of kind "verify": shares [%], cameras, worst places.

    Args:
        found: what was verified.
        worst: so many places at most.
    """
    return found.row() | {"worst": [place.row() for place in worst_places(found, worst)]}


def say_verification(row: Mapping[str, Any]) -> None:
    """Prints such a row."""
    print(
        f"valid     {row['valid_pct']:.2f} % of {row['points']:,} points of {row['voxel_size_m'] * 100:g} cm: "
        f"{row['views']} views, each two at least {row['angle_deg']:g} degrees apart"
    )
    print(
        f"seen      {row['seen_by_one_pct']:.2f} % by one camera or more, {row['seen_by_views_pct']:.2f} % by "
        f"{row['views']} or more; {row['mean_views']:.1f} of {row['cameras']} cameras on average"
    )
    for place in row["worst"]:
        print(f"worst     {place['words']}")


def say_files(files: list[Path], *, walls_known: bool, site: Path | None = None) -> None:
    """Prints what was written, and whether walls were known.

    Args:
        files: pictures, and perhaps a site file.
        walls_known: whether something blocked sight.
        site: which of the files is the site; None: none.
    """
    if not walls_known:
        print(f"note      {NO_WALLS}")
    for path in files:
        print(f"{'site' if path == site else 'picture':9} {path}")


def _two_cells(site: Site, grid: VoxelGrid) -> VoxelGrid:
    """The site's box in as few voxels as compiling needs."""
    return site.grid((grid.upper_m - grid.lower_m).min() / 2)
