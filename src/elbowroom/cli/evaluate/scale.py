"""`elbowroom evaluate scale-cameras` and `scale-budget`: where the scale model's figures come from."""

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from elbowroom.cli.evaluate.options import Jobs, VoxelSizes
from elbowroom.cli.options import JsonFile

FirstPoses = Annotated[
    int | None,
    typer.Option(min=1, metavar="COUNT", help="The first so many of the poses judged. Default: all of them."),
]


def scale_cameras(
    poses: FirstPoses = None,
    step: Annotated[
        int, typer.Option(min=1, metavar="COUNT", help="Ask one of so many candidates; 1: all of them.")
    ] = 1,
    jobs: Jobs = None,
    json: JsonFile = None,
) -> None:
    """Search where the scale model's four Kinects should stand; takes some twenty minutes on two cores."""
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.thesis.scale_cameras import Extent, scale_camera_rows
    from elbowroom.evaluate.thesis.scale_model import POSES
    from elbowroom.geometry.parallel import default_threads

    show = as_table(
        {
            "search": "{search}",
            "score": "{score:.2f}",
            "ways in view": "{ways_in_view} of {ways}",
            "short by [mm]": text("{:.1f}", "median_in_view_mm", "worst_in_view_mm"),
            "all but in view": "{all_but_in_view}",
            "these [mm]": text("{:.1f}", "median_all_but_mm", "worst_all_but_mm"),
            "all [mm]": text("{:.1f}", "median_all_mm", "worst_all_mm"),
            "places [m]": _places,
        },
        "Ways by how much they are short of the contact, median / worst.",
    )
    extent = Extent(min(poses or POSES, POSES), step)
    rows = told(lambda tell: scale_camera_rows(tell, extent, jobs=jobs or default_threads()))
    measured("fours", rows, None, json, show)


def scale_budget(
    voxel_size: VoxelSizes = None, poses: FirstPoses = None, jobs: Jobs = None, json: JsonFile = None
) -> None:
    """Say what the scale model's free travel is lost to, cause by cause; voxels as of the full size."""
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import print_
    from elbowroom.evaluate.thesis.scale_budget import budget_table, groups, scale_budget_rows
    from elbowroom.evaluate.thesis.scale_model import FACTOR, POSES, VOXEL_SIZES_M
    from elbowroom.geometry.parallel import default_threads
    from elbowroom.view.report.tables import rich_table

    asked = groups(min(poses or POSES, POSES), [FACTOR * edge for edge in voxel_size or ()] or VOXEL_SIZES_M)
    rows = told(lambda tell: scale_budget_rows(tell, asked, jobs=jobs or default_threads()))
    measured("groups of poses", rows, None, json, lambda rows: print_(rich_table(budget_table(rows))))


def _places(row: Mapping[str, Any]) -> str:
    return "; ".join(", ".join(f"{x:g}" for x in place) for place in row["places_m"])
