"""`elbowroom view`: a picture of a room, its machine, its cameras, and what they find, without a screen."""

import re
from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import (
    Detail,
    JointsText,
    Rule,
    VoxelSize,
    options_named,
    parse_direction,
    parse_joints,
    parse_resolution,
)
from elbowroom.errors import InputError

PARTS = ("room", "machine", "cameras", "blocked", "sweeps")
"""What a picture can show."""


PictureFile = Annotated[
    Path, typer.Option(metavar="FILE", help="Where it goes; ends in .png, .jpg or .webp.")
]
ViewName = Annotated[
    str, typer.Option("--view", help="From where: iso, top, front or side; the last three to scale.")
]
Eye = Annotated[
    str | None, typer.Option("--from", metavar="X,Y,Z", help="From this point instead, in metres.")
]
Target = Annotated[
    str | None, typer.Option("--to", metavar="X,Y,Z", help="To this point. Default: the box's middle.")
]
Field = Annotated[float, typer.Option("--field", metavar="DEG", help="Field of view, with --from.")]
Size = Annotated[str, typer.Option(metavar="WxH", help="Of the picture, in pixels.")]
Hide = Annotated[
    list[str] | None,
    typer.Option(metavar="PART", help=f"Leave out one of {', '.join(PARTS)}. May be given more than once."),
]
Sweep = Annotated[
    list[str] | None,
    typer.Option(
        metavar="JOINT+|-",
        help="Show what this motion sweeps, such as larm+. May be given more than once. Default: all.",
    ),
]
Near = Annotated[
    float | None,
    typer.Option(
        min=0,
        metavar="METRES",
        help="Show blocked space so near the machine; 0: all. Default: 0.5, none without a machine.",
    ),
]
Reach = Annotated[
    float | None,
    typer.Option(min=0, metavar="METRES", help="Draw fields of view so far. Default: by the room's size."),
]
MomentNumber = Annotated[
    int, typer.Option(min=0, help="Of the recording, from 0; of a simulated room, second.")
]


def view(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="SITE", help="A site file. Default: the simulated intervention room."),
    ] = None,
    picture: PictureFile = Path("view.png"),
    name: ViewName = "iso",
    eye: Eye = None,
    target: Target = None,
    field: Field = 60.0,
    size: Size = "1280x960",
    hide: Hide = None,
    sweep: Sweep = None,
    near: Near = None,
    reach: Reach = None,
    moment: MomentNumber = 0,
    voxel_size: VoxelSize = None,
    rule: Rule = None,
    detail: Detail = None,
    joints: JointsText = None,
) -> None:
    """Draw a room: machine, cameras, blocked space near the machine, and what motions sweep, by level.

    The room is the site's own (key `room`); without one, the surfaces that its
    recording measured. Where there is no recording, the cameras' images are
    simulated in the site's room. Walls between the eye and the room are cut away.
    Needs no screen and no graphics card.
    """
    from elbowroom.cli.view_run import Asked, draw
    from elbowroom.site import Site

    how = {"voxel_size_m": voxel_size, "rule": rule, "detail": detail, "joints": parse_joints(joints)}
    named = {"--resolution": "--size"}
    with options_named(joints="--joints", moment="--moment", view="--view", size="--size", **named):
        asked = Asked(
            name=name,
            eye_m=None if eye is None else point(eye, "--from"),
            target_m=None if target is None else point(target, "--to"),
            field_deg=field,
            size_px=parse_resolution(size),
            parts=tuple(part for part in PARTS if part not in _known(hide or ())),
            sweeps=None if sweep is None else tuple(motion_named(text) for text in sweep),
            near_m=near,
            reach_m=reach,
            moment=moment,
        )
        given = Site.simulated_room() if site is None else Site.load(site)
        draw(given, picture, asked, how)


def _known(hidden: "list[str] | tuple[str, ...]") -> tuple[str, ...]:
    for part in hidden:
        if part not in PARTS:
            raise InputError(f"--hide: {part!r} is no part of a picture; allowed are {', '.join(PARTS)}")
    return tuple(hidden)


def point(text: str, option: str) -> tuple[float, float, float]:
    """A point [m] from "1.5,-2,1".

    Args:
        text: as typed.
        option: that gave it, for the message.

    Raises:
        InputError: not three finite numbers.
    """
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"{option}: {text!r} is no point; write x,y,z in metres, as 1.5,-2,1") from None
    if not all(abs(value) < 1e6 for value in (x, y, z)):
        raise InputError(f"{option}: {text!r} is no point of a room; write x,y,z in metres, as 1.5,-2,1")
    return x, y, z


def motion_named(text: str) -> tuple[str, int]:
    """Joint and direction from "larm+" or "larm -".

    Raises:
        InputError: no + or - at the end.
    """
    found = re.fullmatch(r"(.+?)\s*([+-])", text.strip())
    if found is None:
        raise InputError(f"--sweep: {text!r} is no motion; write a joint and + or -, as larm+")
    return found[1], parse_direction(found[2])
