"""`elbowroom evaluate scale-cameras` and `scale-budget`: where the scale model's figures come from."""

from typing import Annotated

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
            "short by, median [mm]": text("{:.1f}", "median_in_view_mm"),
            "worst": text("{:.1f}", "worst_in_view_mm"),
            "all but in view": "{all_but_in_view}",
            "worst of these": text("{:.1f}", "worst_all_but_mm"),
            "places [m]": lambda row: "; ".join(
                ", ".join(f"{x:g}" for x in place) for place in row["places_m"]
            ),
        }
    )
    extent = Extent(min(poses or POSES, POSES), step)
    rows = told(lambda tell: scale_camera_rows(tell, extent, jobs=jobs or default_threads()))
    measured("fours", rows, None, json, show)


def scale_budget(
    voxel_size: VoxelSizes = None, poses: FirstPoses = None, jobs: Jobs = None, json: JsonFile = None
) -> None:
    """Say what the scale model's free travel is lost to, cause by cause; voxels as of the full size."""
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.due import Row
    from elbowroom.evaluate.tables import Cell
    from elbowroom.evaluate.thesis.scale_budget import CAUSES, groups, scale_budget_rows
    from elbowroom.evaluate.thesis.scale_model import FACTOR, POSES, VOXEL_SIZES_M
    from elbowroom.geometry.parallel import default_threads

    def pair(cause: str) -> Cell:
        return lambda row: " / ".join(f"{mm:.1f}" for mm in row["short_mm"][cause])

    def voxel_and_poses(row: Row) -> str:
        return f"{1000 * row['voxel_size_m']:g} mm{'' if row['judged'] else ', other poses'}"

    columns: dict[str, Cell] = {"voxel": voxel_and_poses, "ways in view": "{in_view} of {motions}"}
    show = as_table(
        columns | {cause: pair(cause) for cause in CAUSES},
        "Short of the truth, median / worst [mm]; each column adds one cause to those before it.",
    )
    asked = groups(min(poses or POSES, POSES), [FACTOR * edge for edge in voxel_size or ()] or VOXEL_SIZES_M)
    rows = told(lambda tell: scale_budget_rows(tell, asked, jobs=jobs or default_threads()))
    measured("groups of poses", rows, None, json, show)
