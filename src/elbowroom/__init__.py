"""How much elbow room does the machine have?

Several fixed depth cameras watch the space that a motorised machine shares with people. Their images become space
*seen to be free*; the machine's own body is taken out; before each movement the system says how far the machine can
go, and whether to go, slow down or stop, and why.

    frames -> what is the machine -> evidence -> free space -> motion checked -> verdict

Elbowroom is a supervisory layer that may only ever reduce motion. It is no certified safety function.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from elbowroom._kernel_cache import forget_stale_kernels

if TYPE_CHECKING:
    from elbowroom.errors import ElbowroomError
    from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
    from elbowroom.machine import Machine
    from elbowroom.machine.c_arm import ceiling_c_arm
    from elbowroom.motion import (
        Cause,
        JointPath,
        Level,
        Motion,
        Verdict,
        braking_distance,
        check_motion,
        check_motions,
        joint_motions,
        most_cautious,
    )
    from elbowroom.reconstruct import Evidence, FreeSpace, carve, merge, reconstruct, resolve, warm_up
    from elbowroom.sensing import NOISE_PRESETS, DepthFrame, JointRecord, Margin, NoiseModel
    from elbowroom.site import Site

forget_stale_kernels()

_HOME = {
    "elbowroom.errors": ("ElbowroomError",),
    "elbowroom.geometry": ("DepthCamera", "Intrinsics", "VoxelGrid"),
    "elbowroom.machine": ("Machine",),
    "elbowroom.machine.c_arm": ("ceiling_c_arm",),
    "elbowroom.motion": (
        "Cause",
        "JointPath",
        "Level",
        "Motion",
        "Verdict",
        "braking_distance",
        "check_motion",
        "check_motions",
        "joint_motions",
        "most_cautious",
    ),
    "elbowroom.reconstruct": ("Evidence", "FreeSpace", "carve", "merge", "reconstruct", "resolve", "warm_up"),
    "elbowroom.sensing": ("NOISE_PRESETS", "DepthFrame", "JointRecord", "Margin", "NoiseModel"),
    "elbowroom.site": ("Site",),
}
_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}

__all__ = [
    "NOISE_PRESETS",
    "Cause",
    "DepthCamera",
    "DepthFrame",
    "ElbowroomError",
    "Evidence",
    "FreeSpace",
    "Intrinsics",
    "JointPath",
    "JointRecord",
    "Level",
    "Machine",
    "Margin",
    "Motion",
    "NoiseModel",
    "Site",
    "Verdict",
    "VoxelGrid",
    "braking_distance",
    "carve",
    "ceiling_c_arm",
    "check_motion",
    "check_motions",
    "joint_motions",
    "merge",
    "most_cautious",
    "reconstruct",
    "resolve",
    "warm_up",
]


def __getattr__(name: str) -> Any:
    """Loads what is asked for when it is asked for, so that the command line starts at once."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'elbowroom' has no attribute {name!r}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)


class _Package(ModuleType):
    """Keeps `elbowroom.reconstruct` the function, where importing the folder of that name would bind the folder."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _MODULE_OF and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
