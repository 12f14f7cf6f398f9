"""Why a voxel is free or not: what each camera saw there."""

from dataclasses import dataclass
from enum import Enum


class Sight(Enum):
    """What a camera can say of a voxel; the value is the sentence that a person reads."""

    THROUGH = "sees through it"
    SURFACE = "measured a surface in it"
    EDGE = "sees past a part of it only"
    BLIND = "looks there without a valid return"
    HIDDEN = "looks there, but something nearer hides it"
    OUTSIDE = "does not have all of it in its image"


@dataclass(frozen=True, slots=True)
class CameraSight:
    """One camera's say of one voxel.

    Args:
        camera: its name.
        sight: what it saw.
        distance_m: from the camera to the voxel's centre [m].
        measured_m: what the centre's pixel measured [m, the camera's kind of depth]; None: no return or outside.
    """

    camera: str
    sight: Sight
    distance_m: float
    measured_m: float | None


@dataclass(frozen=True, slots=True)
class PointReport:
    """Why one voxel is free or not.

    Args:
        index: of the voxel, (i, j, k).
        centre_m: of the voxel, world frame [m].
        state: "free", "surface", "unseen", or "the machine itself".
        cameras: what each camera saw, nearest first.
        could_settle: names of cameras that would see the voxel if what hides or blinds them were gone, nearest first.
    """

    index: tuple[int, int, int]
    centre_m: tuple[float, float, float]
    state: str
    cameras: tuple[CameraSight, ...]
    could_settle: tuple[str, ...]

    def __str__(self) -> str:
        x, y, z = self.centre_m
        lines = [f"voxel {self.index} around ({x:.2f}, {y:.2f}, {z:.2f}) m is {self.state}"]
        for sight in Sight:
            names = [seen.camera for seen in self.cameras if seen.sight is sight]
            if names:
                lines.append(f"  {', '.join(names)}: {sight.value}")
        if self.could_settle:
            lines.append(f"  could settle it with a clear view: {', '.join(self.could_settle)}")
        return "\n".join(lines)
