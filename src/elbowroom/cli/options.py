"""Options that several commands share, and what people may type for them."""

import math
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowroom import choices
from elbowroom.errors import InputError

SitePath = Annotated[
    Path, typer.Argument(metavar="SITE", help="A site file (YAML); elbowroom site new writes one.")
]
PagePort = Annotated[
    int | None,
    typer.Option(
        min=0, max=65535, help="Port of the page, at 127.0.0.1. Default: 8137, or any that is free."
    ),
]
FoxglovePort = Annotated[
    int, typer.Option(min=0, max=65535, help="Another port for Foxglove, at 127.0.0.1. 0: any that is free.")
]
Language = Annotated[str, typer.Option(help="Words of the page: en, de.")]
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write the results as JSON: meta and rows.")
]
Rule = Annotated[
    choices.Rule | None, typer.Option("--rule", help="How cameras are combined. Default: the site's.")
]
Detail = Annotated[
    choices.Detail | None,
    typer.Option("--detail", help="How closely images are looked at. Default: the site's."),
]
VoxelSize = Annotated[
    float | None,
    typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel. Default: the site's."),
]
JointsText = Annotated[
    str | None,
    typer.Option(
        "--joints",
        metavar="NAME=VALUE,...",
        help="Joint positions that hold throughout, such as long=0.1,larm=12deg; plain: m or rad.",
    ),
]

IN_BASE_UNITS: dict[str, tuple[float, Literal["m", "rad"]]] = {
    "m": (1.0, "m"),
    "mm": (1e-3, "m"),
    "rad": (1.0, "rad"),
    "deg": (math.pi / 180, "rad"),
}
"""Units of joint positions that may be typed."""


def parse_joints(text: str | None) -> dict[str, float] | None:
    """Joint positions [m or rad] by name from "long=0.1,larm=12deg"; those with a unit know it (`WrittenPosition`).

    Raises:
        InputError: something between two commas is not name=number, perhaps with m, mm, rad or deg behind it.
    """
    if text is None:
        return None
    joints: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (word.strip() for word in part.partition("="))
        match = re.fullmatch(r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(m|mm|rad|deg)?", value)
        try:
            joints[name] = _position(match[1], match[2]) if match and name else math.nan
        except ValueError:
            joints[name] = math.nan
        if not math.isfinite(joints[name]):
            raise InputError(
                f"--joints: {part.strip()!r} is no joint position; write name=value, as long=0.1,larm=12deg"
            )
    return joints


def _position(number: str, unit: str | None) -> float:
    """A position [m or rad] of a number and perhaps a unit."""
    if unit is None:
        return float(number)
    from elbowroom.machine.joint_state import WrittenPosition  # slow to load, and no list of options needs it

    factor, base = IN_BASE_UNITS[unit]
    return WrittenPosition(float(number) * factor, base, f"{number}{unit}")


def parse_resolution(text: str) -> tuple[int, int]:
    """Width and height [px] from "160x120".

    Raises:
        InputError: not two whole numbers above zero with an x between them.
    """
    match = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text.strip().lower())
    if not match or min(int(match[1]), int(match[2])) < 1:
        raise InputError(
            f"--resolution: {text!r} is no size of an image; write width x height, such as 160x120"
        )
    return int(match[1]), int(match[2])


def parse_direction(text: str) -> int:
    """+1 or -1 from "+" or "-".

    Raises:
        InputError: anything else.
    """
    directions = {"+": 1, "+1": 1, "1": 1, "-": -1, "-1": -1}
    if text not in directions:
        raise InputError(f"--direction: {text!r} is no direction; allowed are + and -")
    return directions[text]


@contextmanager
def options_named(**options: str) -> Iterator[None]:
    """What the library says of an argument is said of the option that gave it.

    Args:
        options: by argument, such as knocks="--knock": an error "knocks: ..." becomes "--knock: ...".
    """
    try:
        yield
    except InputError as error:
        argument, colon, rest = str(error).partition(":")
        if colon and argument in options:
            raise type(error)(f"{options[argument]}:{rest}") from None
        raise


def use_threads(count: int | None) -> None:
    """Keeps this process on so many cores; None: all that it has.

    Raises:
        InputError: below one, more than there are, or a system on which a process cannot be kept to cores.
    """
    if count is None:
        return
    if not hasattr(os, "sched_setaffinity"):
        raise InputError("--threads: this system cannot keep a process to some of its cores; leave it out")
    cores = sorted(os.sched_getaffinity(0))
    if not 1 <= count <= len(cores):
        raise InputError(f"--threads: {count} threads, this process may use 1 to {len(cores)}")
    os.sched_setaffinity(0, cores[:count])
