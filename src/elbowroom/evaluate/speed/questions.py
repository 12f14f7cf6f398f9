"""The questions of `elbowroom bench --all`, a few cases each: what a cycle costs by one thing at a time."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from elbowroom.choices import Detail
from elbowroom.evaluate.due import Due, where

Scene = Literal["people walking", "nothing moves", "every pixel changes", "balls"]
Part = Literal["cycle", "carve"]
ROUNDS = 8
"""Of most cases; few, so that all of them take ten minutes."""
HEADLINE = "headline"


@dataclass(frozen=True, slots=True)
class Asked:
    """One case of a question.

    Args:
        question: of which it is one, as a heading.
        voxel_size_m: edge of a voxel [m].
        detail: of the carve.
        noise: whether the cameras have noise and margins.
        cameras, width, height: how many, and their images [px].
        scene: what they see.
        threads: over so many the work is spread.
        part: a whole cycle of the room with the machine, or a carve of all the grid.
        half_m: scene balls: half the edge of the grid [m].
        balls: scene balls: how many.
        rounds: how many times it is measured.
    """

    question: str
    voxel_size_m: float = 0.02
    detail: Detail = "pixel"
    noise: bool = True
    cameras: int = 21
    width: int = 640
    height: int = 480
    scene: Scene = "people walking"
    threads: int = 2
    part: Part = "cycle"
    half_m: float = 0.0
    balls: int = 0
    rounds: int = ROUNDS


BALL_M = 0.15
"""Radius of the balls [m]."""
SIZES = ((64, 48), (160, 120), (320, 240), (640, 480), (1280, 720))
DUE = tuple(
    Due("p99_ms", "≤", ms, where(question=question, voxel_size_m=edge, detail=detail, **more))
    for question, edge, detail, ms, more in (
        (HEADLINE, 0.02, "pixel", 33.0, {}),
        (HEADLINE, 0.05, "pixel", 15.0, {}),
        (HEADLINE, 0.02, "footprint", 25.0, {}),
        (HEADLINE, 0.05, "footprint", 8.0, {}),
        ("voxels", 0.01, "pixel", 120.0, {}),
        ("cameras", 0.02, "pixel", 12.0, {"cameras": 6}),
    )
) + (
    Due("peak_rss_mb", "≤", 350.0, where(question=HEADLINE, voxel_size_m=0.02)),
    Due("peak_rss_mb", "≤", 700.0, where(question="voxels", voxel_size_m=0.01)),
)
"""On two cores."""


def all_asked(rounds: int = ROUNDS, longest: int = 60) -> Iterator[Asked]:
    """Every case of every question.

    Args:
        rounds: of most cases.
        longest: rounds of the headline's.
    """
    usual = Asked(HEADLINE, rounds=rounds)
    for edge in (0.02, 0.05):
        for detail in ("pixel", "footprint"):
            yield replace(usual, voxel_size_m=edge, detail=detail, rounds=longest)
    for edge in (0.1, 0.05, 0.02, 0.01):
        yield replace(usual, question="voxels", voxel_size_m=edge)
    for cameras in (1, 2, 4, 6, 10, 21, 40, 64):
        yield replace(usual, question="cameras", cameras=cameras)
    for width, height in SIZES:
        yield replace(usual, question="pixels", width=width, height=height)
    for scene in ("nothing moves", "people walking", "every pixel changes"):
        yield replace(usual, question="what moves", scene=scene)
    for threads in (1, 2):
        yield replace(usual, question="threads", threads=threads)
    hall = replace(
        usual, scene="balls", part="carve", noise=False, width=320, height=240, voxel_size_m=0.04, balls=1
    )
    for half in (0.5, 0.8, 1.25, 2.0):
        yield replace(hall, question="volume", half_m=half)
    for balls in (1, 4, 16, 64):
        yield replace(hall, question="surface", half_m=1.25, balls=balls)
