"""`elbowroom reconstruct`: one moment of a site to free space, as arrays, points and pictures."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import (
    Detail,
    JointsText,
    JsonFile,
    Rule,
    SitePath,
    VoxelSize,
    options_named,
    parse_joints,
)


def reconstruct(
    site: SitePath,
    out: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for free_space.npz, blocked.ply and pictures.")
    ],
    moment: Annotated[int, typer.Option(min=0, help="Which moment of the recording, from 0.")] = 0,
    rule: Rule = None,
    detail: Detail = None,
    voxel_size: VoxelSize = None,
    joints: JointsText = None,
    json: JsonFile = None,
) -> None:
    """Turn the depth images of one moment into free space.

    Writes free_space.npz (grid and bool planes), blocked.ply (centres of blocked
    voxels, coloured) and sections as PNG, with the machine drawn in.
    """
    positions = parse_joints(joints)

    from elbowroom.cli.reconstruct_run import export
    from elbowroom.site import Site
    from elbowroom.sources import open_room

    with options_named(joints="--joints", moment="--moment"):
        room = open_room(Site.load(site), voxel_size_m=voxel_size, rule=rule, detail=detail, joints=positions)
        export(room, moment, out, json)
