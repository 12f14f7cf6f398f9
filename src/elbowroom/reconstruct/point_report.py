"""Why a voxel is free or not: what each camera saw there."""

from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any


class Sight(Enum):
    """What a camera can say of a voxel; the value is the sentence that a person reads."""

    THROUGH = "sees through it"
    SURFACE = "measured a surface in it"
    EDGE = "sees past a part of it only"
    BLIND = "looks there without a valid return"
    HIDDEN = "looks there, but something nearer hides it"
    AGED = "saw through it, so long ago that something may have come since"
    OUTSIDE = "does not have all of it in its image"


@dataclass(frozen=True, slots=True)
class CameraSight:
    """One camera's say of one voxel. Depths are of the camera's kind.

    Args:
        camera: its name.
        sight: what it saw.
        distance_m: from the camera to the voxel's centre [m].
        measured_m: what the centre's pixel measured [m]; None: no return or outside.
        reach_m: depth of the voxel's nearest and farthest point [m]; None: it is not all in the image.
        least_m: the least that the pixels about the voxel measured, the machine's own apart [m]; None: nothing.
        margin_m: how far depth is not trusted at the voxel's farthest point [m].
        sigma_m: standard deviation of depth there [m]; 0: an exact camera.
        without_return: share of the pixels about the voxel that have no valid return, 0 to 1.
    """

    camera: str
    sight: Sight
    distance_m: float
    measured_m: float | None
    reach_m: tuple[float, float] | None = None
    least_m: float | None = None
    margin_m: float = 0.0
    sigma_m: float = 0.0
    without_return: float = 0.0

    @property
    def beyond_m(self) -> float | None:
        """How far behind the voxel the nearest thing was measured [m]; below zero: before its farthest point."""
        if self.reach_m is None or self.least_m is None:
            return None
        return self.least_m - self.reach_m[1]

    def __str__(self) -> str:
        """In numbers: what was measured, where the voxel lies, and what the margin is."""
        if self.reach_m is None:
            return f"{self.camera}: {self.sight.value}"
        near, far = self.reach_m
        margin = f"its margin there is {1e3 * self.margin_m:.0f} mm (sigma {1e3 * self.sigma_m:.0f} mm)"
        text = f"{self.camera}, {self.distance_m:.2f} m away: the voxel lies at {near:.3f} to {far:.3f} m; "
        if self.without_return > 0:
            text += f"{100 * self.without_return:.0f} % of the pixels about it have no return; "
        beyond = self.beyond_m
        if beyond is None or self.least_m is None:
            return f"{text}nothing was measured but the machine; {margin}"
        if beyond > self.margin_m:
            return f"{text}measured {self.least_m:.3f} m, {1e3 * beyond:.0f} mm behind it; {margin}"
        if beyond >= 0:
            return f"{text}measured {self.least_m:.3f} m, only {1e3 * beyond:.0f} mm behind it; {margin}"
        if self.least_m >= near:
            return f"{text}measured {self.least_m:.3f} m, in it; {margin}"
        return (
            f"{text}measured {self.least_m:.3f} m, {1e3 * (near - self.least_m):.0f} mm before it; {margin}"
        )

    def row(self) -> dict[str, Any]:
        """As part of a row of results."""
        return asdict(self) | {"sight": self.sight.name.lower(), "beyond_m": self.beyond_m}


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
