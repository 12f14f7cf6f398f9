"""`elbowroom evaluate`: how right the answers are."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowroom.cli.options import JsonFile

evaluate_app = typer.Typer(help="Measure how right the answers are.", no_args_is_help=True)

Poses = Annotated[int, typer.Option(min=1, metavar="COUNT", help="How many random poses.")]
Cameras = Annotated[int, typer.Option(min=1, max=255, help="How many cameras, along the walls.")]
Size = Annotated[Literal["vga", "qqvga", "thesis"], typer.Option(help="Of their images.")]
Seed = Annotated[int, typer.Option(min=0, help="Of the random poses; the same seed gives the same poses.")]
VoxelSizes = Annotated[
    list[float] | None,
    typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel; may be given more than once."),
]
OneVoxelSize = Annotated[float, typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel.")]


@evaluate_app.command(epilog="Example: elbowroom evaluate room --json room.json")
def room(
    voxel_size: VoxelSizes = None, cameras: Cameras = 21, size: Size = "vga", json: JsonFile = None
) -> None:
    """Compare with the exact truth of the simulated room: occupied voxels kept, free voxels found."""
    from elbowroom.cli.evaluate.run import run_room

    run_room(tuple(voxel_size or (0.05, 0.02)), cameras, size, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate sevenscenes --json sevenscenes.json")
def sevenscenes(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="[SITE]", help="Default: examples/sevenscenes.yaml of a checkout."),
    ] = None,
    voxel_size: VoxelSizes = None,
    json: JsonFile = None,
) -> None:
    """Compare with views of a real room that were kept apart: measured surface points in free space."""
    from elbowroom.cli.evaluate.run import run_sevenscenes

    run_sevenscenes(site, tuple(voxel_size or (0.05,)), json)


@evaluate_app.command(epilog="Example: elbowroom evaluate alone --json alone.json")
def alone(
    poses: Poses = 20,
    voxel_size: VoxelSizes = None,
    cameras: Cameras = 21,
    size: Size = "vga",
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Check all motions of the C-arm alone in the room, with sensor noise: all must be clear."""
    from elbowroom.cli.evaluate.run import run_alone

    run_alone(tuple(voxel_size or (0.02, 0.05)), poses, cameras, size, seed, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate poses --poses 20 --json poses.json")
def poses(
    poses: Poses = 200,
    voxel_size: OneVoxelSize = 0.02,
    cameras: Cameras = 21,
    size: Size = "vga",
    seed: Seed = 2,
    json: JsonFile = None,
) -> None:
    """Compare verdicts from depth images with exact geometry, in the whole room at random moments."""
    from elbowroom.cli.evaluate.run import run_poses

    run_poses(voxel_size, poses, cameras, size, seed, json)


@evaluate_app.command(epilog="Example: elbowroom evaluate travel --json travel.json")
def travel(
    poses: Poses = 200, voxel_size: OneVoxelSize = 0.02, seed: Seed = 3, json: JsonFile = None
) -> None:
    """Compare free travel in the true volume with exact mesh distance."""
    from elbowroom.cli.evaluate.run import run_travel

    run_travel(voxel_size, poses, seed, json)


@evaluate_app.command(
    epilog="Example: elbowroom evaluate bits --json now.json --against benchmarks/results/bits.json"
)
def bits(
    examples: Annotated[
        Path | None,
        typer.Argument(metavar="[EXAMPLES]", help="Folder of site files. Default: examples of a checkout."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the recordings. Default: ELBOWROOM_DATA, or as the site files say."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A few cases only.")] = False,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="A file that this command wrote before; exits with 1 if rows differ."
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Check sums of free space and verdicts, by every rule and detail: whether a change of the code changed a bit."""
    from elbowroom.cli.evaluate.bits_run import run_bits

    run_bits(examples, data, quick, against, json)
