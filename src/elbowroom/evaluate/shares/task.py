"""A piece of an evaluation that runs by itself: anywhere, in any order, with the same outcome."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a task found.

    Args:
        rows: for the file of results; plain values only, and no times: whoever runs it finds the same.
        pictures: PNG files by name.
    """

    rows: list[dict[str, Any]]
    pictures: dict[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Task:
    """A function and what it is called with.

    Args:
        part: the evaluation that it belongs to, such as "reconstruction".
        name: unique within the part; letters, digits, dots and dashes.
        work: a function of a module, so that other processes find it.
        arguments: plain values.
    """

    part: str
    name: str
    work: Callable[..., Outcome]
    arguments: Mapping[str, Any]

    def run(self) -> Outcome:
        """Does it."""
        return self.work(**self.arguments)

    def fingerprint(self, source: str) -> str:
        """The same for the same work by the same source."""
        words = json.dumps([source, self.part, self.name, dict(self.arguments)], sort_keys=True, default=str)
        return hashlib.sha256(words.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Settings:
    """How much of the evaluations is run.

    Args:
        setups: numbers of the thesis' setups.
        voxel_sizes_m: edges of voxels [m]; None: each evaluation's own.
        sensors: names of `SENSORS`.
        draws: of disturbed poses at each size of error.
        random_motions: how many of them.
        cameras: along the walls.
        pictures: whether to draw.
    """

    setups: tuple[int, ...] = (1, 2, 3, 4, 5, 6)
    voxel_sizes_m: tuple[float, ...] | None = None
    sensors: tuple[str, ...] = ("640x480", "64x48")
    draws: int = 50
    random_motions: int = 500
    cameras: int = 21
    pictures: bool = True
