"""Something in the simulated room that is knocked: a camera on its mount, or a joint whose sensor reads wrong."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera

_FORM = re.compile(
    r"(?P<what>[^:@]+):(?P<size>[-+]?[0-9.]+)(?P<unit>deg|mm|cm)(?P<axis>[xyz]?)(?:@(?P<at>[0-9.]+))?"
)
USUAL_AXIS = {"deg": "y", "mm": "x", "cm": "x"}
"""A knock turns a camera sideways and pushes it sideways, unless it says otherwise."""
IN_BASE_UNITS = {"deg": math.pi / 180, "mm": 1e-3, "cm": 1e-2}


@dataclass(frozen=True, slots=True)
class Knock:
    """A camera that turns or moves, or a joint that is elsewhere than it says, from some time on.

    Args:
        what: name of a camera or of a joint.
        turn_rad: rotation vector, the camera's axes; of a joint its first number counts [rad].
        move_m: the camera's axes; of a joint its first number counts [m].
        at_s: when it happens [s after the start].
    """

    what: str
    turn_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    move_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    at_s: float = 0.0

    @classmethod
    def parse(cls, text: str) -> "Knock":
        """From "cam03:1deg@5", "cam03:20mmz@5" (axis z), "larm:2deg@5": what, how far, about or along which axis, when.

        Raises:
            InputError: any other form, or a size that is no number.
        """
        match = _FORM.fullmatch(text.strip())
        try:
            size = float(match["size"]) * IN_BASE_UNITS[match["unit"]] if match else math.nan
            at_s = float(match["at"] or 0.0) if match else math.nan
        except ValueError:
            size = at_s = math.nan
        if match is None or not (math.isfinite(size) and math.isfinite(at_s)):
            raise InputError(
                f"knocks: {text!r} is no knock; write camera:size[axis]@seconds, as cam03:1deg@5 or cam03:20mmz@5, "
                "or joint:size@seconds, as larm:2deg@5"
            )
        axis = "xyz".index(match["axis"] or USUAL_AXIS[match["unit"]])
        along = (size * (axis == 0), size * (axis == 1), size * (axis == 2))
        nothing = (0.0, 0.0, 0.0)
        if match["unit"] == "deg":
            return cls(match["what"], along, nothing, at_s)
        return cls(match["what"], nothing, along, at_s)

    @property
    def along_joint(self) -> float:
        """By how much a joint is elsewhere than it says [m or rad]."""
        return sum(self.turn_rad) + sum(self.move_m)

    @property
    def old_from_new(self) -> NDArray[np.float64]:
        """The camera's new pose in its old axes, shape (4, 4)."""
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(self.turn_rad).as_matrix()
        pose[:3, 3] = self.move_m
        return pose

    def camera(self, camera: DepthCamera) -> DepthCamera:
        """The camera where it truly is after the knock."""
        return replace(camera, world_from_camera=camera.world_from_camera @ self.old_from_new)


def require_known(knocks: Sequence[Knock], cameras: Sequence[DepthCamera], joints: Sequence[str]) -> None:
    """Checks that every knock meets something.

    Args:
        knocks: what happens.
        cameras, joints: what there is, joints by name.

    Raises:
        InputError: a name that is neither a camera nor a joint.
    """
    names = [camera.name for camera in cameras]
    for knock in knocks:
        if knock.what not in names and knock.what not in joints:
            raise InputError(
                f"knocks: nothing is called {knock.what!r}; cameras are {', '.join(names)}, joints "
                f"{', '.join(joints) or 'none'}"
            )


class PlacedKnocks:
    """The cameras before and after their knocks, each made once: what never moves is cast once for each camera.

    Args:
        knocks: those of joints do nothing here.
        cameras: where they are said to be.
    """

    def __init__(self, knocks: Sequence[Knock], cameras: Sequence[DepthCamera]) -> None:
        by_name = {camera.name: camera for camera in cameras}
        self._cameras = tuple(cameras)
        mine = [knock for knock in knocks if knock.what in by_name]
        self._after = [(knock, knock.camera(by_name[knock.what])) for knock in mine]

    def cameras(self, time_s: float) -> tuple[DepthCamera, ...]:
        """Where they truly are at a time: of each camera's knocks that have happened the last one counts."""
        happened = {knock.what: camera for knock, camera in self._after if time_s >= knock.at_s}
        return tuple(happened.get(camera.name, camera) for camera in self._cameras)


def reported_joints(knocks: Sequence[Knock], joints: Mapping[str, float], time_s: float) -> dict[str, float]:
    """What the joints say at a time, given where they truly are.

    Args:
        knocks: those of cameras do nothing here.
        joints: where they truly are [m or rad].
        time_s: since the start [s].
    """
    happened = {knock.what: knock.along_joint for knock in knocks if time_s >= knock.at_s}
    return {name: value - happened.get(name, 0.0) for name, value in joints.items()}
