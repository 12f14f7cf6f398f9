"""`elbowroom check`: one motion or path, one verdict, in words."""

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
from elbowroom.errors import InputError


def check(
    site: SitePath,
    joint: Annotated[str | None, typer.Option(metavar="NAME", help="The joint that shall move.")] = None,
    direction: Annotated[
        str | None, typer.Option(metavar="+|-", help="Which way its value shall change.")
    ] = None,
    path: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="A path instead: CSV with columns time_s and joints, or a JointTrajectory as YAML or JSON.",
        ),
    ] = None,
    horizon: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Of a path, how far ahead to look. Default: all of it."),
    ] = None,
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
    """Say how far one joint may move, or a path may be followed, what ends that, and what each camera saw there.

    With --joint and --direction: one motion. With --path: how long the machine may
    follow it so that a stop, at any moment until then, ends at rest in free space.
    Of each camera that does not see through: what it measured, where the voxel
    lies, how far its depth is not trusted there; and what would change it.
    """
    way, positions = _asked(joint, direction, path, horizon, out), parse_joints(joints)

    from elbowroom.cli.check_path_run import ask_path
    from elbowroom.cli.check_run import ask
    from elbowroom.site import Site
    from elbowroom.sources import open_room

    with options_named(joints="--joints", moment="--moment"):
        room = open_room(Site.load(site), voxel_size_m=voxel_size, rule=rule, detail=detail, joints=positions)
        if path is not None:
            ask_path(room, (path, horizon), moment, json)
        elif joint is not None and way is not None:
            ask(room, (joint, way), moment, json, out)


def _asked(
    joint: str | None, direction: str | None, path: Path | None, horizon: float | None, out: Path | None
) -> int | None:
    """The direction of a motion, +1 or -1; None: a path is asked.

    Raises:
        InputError: neither a motion nor a path, or something of both.
    """
    if path is None:
        if joint is None or direction is None:
            raise InputError("check: give --joint and --direction, or --path")
        if horizon is not None:
            raise InputError("--horizon: only with --path")
        return parse_direction(direction)
    for name, value in (("--joint", joint), ("--direction", direction), ("--out", out)):
        if value is not None:
            raise InputError(f"{name}: not with --path")
    if horizon is not None and not horizon > 0:
        raise InputError(f"--horizon: is {horizon:g}, must be above 0 [s]")
    return None
