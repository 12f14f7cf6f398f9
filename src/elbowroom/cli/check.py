"""`elbowroom check`: one motion, one verdict, in words."""

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
    parse_direction,
    parse_joints,
)


def check(
    site: SitePath,
    joint: Annotated[str, typer.Option(metavar="NAME", help="The joint that shall move.")],
    direction: Annotated[str, typer.Option(metavar="+|-", help="Which way its value shall change.")],
    moment: Annotated[int, typer.Option(min=0, help="Which moment of the recording, from 0.")] = 0,
    rule: Rule = None,
    detail: Detail = None,
    voxel_size: VoxelSize = None,
    joints: JointsText = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Write, for each camera, the part of its image about the voxel that ends the way, drawn in.",
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Say how far one joint may move, what ends its way, and what each camera saw there.

    Of each camera that does not see through: what it measured, where the voxel
    lies, how far its depth is not trusted there; and what would change it.
    """
    way, positions = parse_direction(direction), parse_joints(joints)

    from elbowroom.cli.check_run import ask
    from elbowroom.site import Site
    from elbowroom.sources import open_room

    with options_named(joints="--joints", moment="--moment"):
        room = open_room(Site.load(site), voxel_size_m=voxel_size, rule=rule, detail=detail, joints=positions)
        ask(room, (joint, way), moment, json, out)
