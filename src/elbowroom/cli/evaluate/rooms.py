"""`elbowroom evaluate room`, `sevenscenes`, `alone`, `poses`, `travel`, `thin-solids`, `lost-pixels`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Cameras, OneVoxelSize, Poses, Seed, Size, VoxelSizes
from elbowroom.cli.options import JsonFile

MOTIONS = 8
"""Four joints of the C-arm in two directions."""


def room(
    voxel_size: VoxelSizes = None, cameras: Cameras = 21, size: Size = "vga", json: JsonFile = None
) -> None:
    """Compare with the exact truth of the simulated room: occupied voxels kept, free voxels found."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, voxel, yes_or_no
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.rooms.room import DUE, room_rows

    edges = tuple(voxel_size or (0.05, 0.02))
    show = as_table(
        {
            "voxel": voxel,
            "detail": "{detail}",
            "noise": yes_or_no("noise"),
            "occupied kept": "{occupied_pct:.4f} %",
            "found": "{found_pct:.2f} %",
        },
        sentence(DUE, "with 21 cameras of 640x480"),
    )
    measured("voxels", room_rows(edges, cameras=cameras, size=size), 6 * len(edges), json, show)


def sevenscenes(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="SITE", help="Default: examples/sevenscenes.yaml of a checkout."),
    ] = None,
    voxel_size: VoxelSizes = None,
    json: JsonFile = None,
) -> None:
    """Compare with views of a real room that were kept apart: measured surface points in free space."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, voxel
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.examples import example
    from elbowroom.evaluate.rooms.sevenscenes import DUE, sevenscenes_rows

    edges = tuple(voxel_size or (0.05,))
    show = as_table(
        {
            "voxel": voxel,
            "margin": "{margin}",
            "detail": "{detail}",
            "rule": "{rule}",
            "free": "{free_pct:.2f} %",
            "false": "{false_pct:.3f} %",
        },
        sentence(DUE, "at 5 cm, of one detail and margin of a rule"),
    )
    rows = sevenscenes_rows(site or example("sevenscenes"), edges)
    measured("rules and details", rows, 24 * len(edges), json, show)


def alone(
    poses: Poses = 20,
    voxel_size: VoxelSizes = None,
    cameras: Cameras = 21,
    size: Size = "vga",
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Check all motions of the C-arm alone in the room, with sensor noise: all must be clear."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, voxel
    from elbowroom.evaluate.rooms.alone import DUE, alone_rows, alone_summary

    edges = tuple(voxel_size or (0.02, 0.05))
    counts = ("poses", "verdicts", "clear", "inform", "decelerate", "stop")
    show = as_table({"voxel": voxel, **{name: f"{{{name}}}" for name in counts}, "due": DUE[0].words})
    rows = alone_rows(edges, poses=poses, cameras=cameras, size=size, seed=seed)
    measured("verdicts", rows, MOTIONS * poses * len(edges), json, show, alone_summary)


def poses(
    poses: Poses = 200,
    voxel_size: OneVoxelSize = 0.02,
    cameras: Cameras = 21,
    size: Size = "vga",
    noise: Annotated[
        bool,
        typer.Option("--noise", help="Of time-of-flight cameras, with flying pixels. Default: exact images."),
    ] = False,
    seed: Seed = 2,
    json: JsonFile = None,
) -> None:
    """Compare verdicts from depth images with exact geometry, in the whole room at random moments."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_figures
    from elbowroom.evaluate.rooms.poses import DUE, poses_rows, poses_summary

    show = as_figures(
        DUE,
        ("poses", "poses", "{}"),
        ("verdicts", "verdicts", "{}"),
        ("milder than exact geometry", "milder", "{}"),
        ("truly clear over the whole reach", "truly_clear", "{}"),
        ("of these stop", "stop_where_clear_pct", "{:.1f} %"),
        ("of these clear", "clear_where_clear_pct", "{:.1f} %"),
        ("same level as exact geometry", "same_level_pct", "{:.1f} %"),
    )
    rows = poses_rows(voxel_size, poses=poses, cameras=cameras, size=size, noise=noise, seed=seed)
    measured("verdicts", rows, MOTIONS * poses, json, show, lambda rows: [poses_summary(rows)])


def travel(
    poses: Poses = 200, voxel_size: OneVoxelSize = 0.02, seed: Seed = 3, json: JsonFile = None
) -> None:
    """Compare free travel in the true volume with exact mesh distance."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_figures
    from elbowroom.evaluate.rooms.travel import DUE, travel_rows, travel_summary

    show = as_figures(
        DUE,
        ("poses", "poses", "{}"),
        ("motions", "motions", "{}"),
        ("more travel than the truth", "more_than_truth", "{}"),
        ("motions that touch something", "touching", "{}"),
        ("median shortfall of these", "median_shortfall_voxels", "{:.2f} voxels"),
        ("greatest shortfall", "greatest_shortfall_voxels", "{:.2f} voxels"),
    )
    rows = travel_rows(voxel_size, poses=poses, seed=seed)
    measured("motions", rows, MOTIONS * poses, json, show, lambda rows: [travel_summary(rows)])


def thin_solids(
    scenes: Annotated[int, typer.Option(min=1, metavar="COUNT", help="Random scenes of each kind.")] = 200,
    json: JsonFile = None,
) -> None:
    """Count voxels touched by boxes with corners and by thin rods that are declared free: what no promise covers."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.rooms.thin_solids import ROWS, thin_solid_rows

    show = as_table(
        {
            "solid": "{solid}",
            "cameras": "{cameras}",
            "rule": "{rule}",
            "detail": "{detail}",
            "touched voxels": "{touched_voxels}",
            "declared free": "{false_free_voxels}",
            "in scenes": "{scenes_with_false_free} of {scenes}",
            "occupied kept": "{occupied_pct:.4f} %",
        }
    )
    measured("solids, cameras and details", thin_solid_rows(scenes), ROWS, json, show)


def lost_pixels(
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the recordings. Default: $ELBOWROOM_DATA, or else ../shared/data."
        ),
    ] = None,
    images: Annotated[
        int | None, typer.Option(min=1, metavar="COUNT", help="So many of each recording. Default: all.")
    ] = None,
    json: JsonFile = None,
) -> None:
    """Count pixels that real depth cameras lose on smooth surfaces, by how obliquely they see them."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.rooms.lost_pixels import ROWS, lost_pixel_rows

    folder = data or Path(os.environ.get("ELBOWROOM_DATA", "../shared/data"))
    show = as_table(
        {
            "recording": "{recording}",
            "tangent from": "{tangent_from:g}",
            "to": text("{:g}", "tangent_to"),
            "pixels": "{pixels}",
            "lost": text("{:.3f} %", "lost_pct"),
        }
    )
    measured("ranges of tangents", lost_pixel_rows(folder, images), ROWS, json, show)
