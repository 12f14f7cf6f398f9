"""Arguments and options that the commands of `elbowroom placement` share, and what each command is told."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

OptionalSite = Annotated[
    Path | None,
    typer.Argument(metavar="SITE", help="A site file (YAML). Default: the room of the thesis."),
]
Views = Annotated[
    int | None,
    typer.Option(min=1, metavar="COUNT", help="Views that a point needs. Default: the site's, or 3."),
]
Angle = Annotated[
    float | None,
    typer.Option(
        metavar="DEGREES", help="Least angle between two views from above. Default: the site's, or 100."
    ),
]
Motions = Annotated[
    bool,
    typer.Option(
        "--motions",
        help="Place them for what the machine's motions sweep in random scenes, so that few stop for nothing.",
    ),
]
Scenes = Annotated[
    int,
    typer.Option(
        min=0,
        metavar="COUNT",
        help="Judge by the free space found in so many random scenes instead. With --motions: 8 if not given.",
    ),
]
People = Annotated[
    int, typer.Option(min=0, metavar="COUNT", help="In scenes of a room that is not the simulated one.")
]
WithTable = Annotated[bool, typer.Option("--table/--no-table", help="Whether such a room gets a table.")]
Pictures = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write pictures into this folder.")
]


@dataclass(frozen=True, slots=True)
class Required:
    """What a point must have to be valid; None: as the site says."""

    views: int | None
    angle_deg: float | None


@dataclass(frozen=True, slots=True)
class VerifyOptions:
    """What `placement verify` is told; see its help."""

    site: Path
    required: Required
    voxel_size_m: float | None
    worst: int
    out: Path | None


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """What `placement sweep` is told; see its help."""

    site: Path | None
    sensors: tuple[str, ...]
    counts: str
    walls_m: tuple[float, ...]
    heights_m: tuple[float, ...]
    aim_m: float | None
    share_pct: float
    required: Required
    voxel_size_m: float
    out: Path | None


@dataclass(frozen=True, slots=True)
class OptimiseOptions:
    """What `placement optimise` is told; see its help."""

    site: Path | None
    share_pct: float
    cameras: int | None
    by_price: bool
    keep: bool
    motions: bool
    scenes: int
    people: int
    table: bool
    seconds: float
    points: int
    required: Required
    seed: int
    write: Path | None
    out: Path | None


@dataclass(frozen=True, slots=True)
class SimulateOptions:
    """What `placement simulate` is told; see its help."""

    site: Path | None
    scenes: int
    people: int
    table: bool
    voxel_size_m: float | None
    by_camera: bool
    seed: int


@dataclass(frozen=True, slots=True)
class CapabilityOptions:
    """What `placement capability` is told; see its help."""

    site: Path
    views: int
    voxel_size_m: float | None
    out: Path | None
