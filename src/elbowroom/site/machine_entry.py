"""The machine and the speeds of its joints as a site file describes them."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import model_validator

from elbowroom.errors import SiteError
from elbowroom.machine import Joint, Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Motion, braking_distance
from elbowroom.site.entry import Entry, Matrix, Positive, Text
from elbowroom.site.paths import expand
from elbowroom.site.ranges import MILLIMETRES, MILLISECONDS, MM_A_SECOND, up_to


class MachineEntry(Entry):
    """The machine: one that ships with the package, or a URDF; where its base stands; links not to check.

    `explain_tolerance_m` is how far from its model a measured point may lie and still be the machine itself. On a
    `free_base` the machine drives or floats, and where it stands is among its joint positions.
    """

    builtin: Literal["ceiling_c_arm"] | None = None
    urdf: Text | None = None
    world_from_base: Matrix | None = None
    unchecked_links: tuple[Text, ...] = ()
    explain_tolerance_m: Annotated[Positive, up_to(0.5, "m", MILLIMETRES)] | None = None
    free_base: Literal["planar", "floating"] | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "MachineEntry":
        if (self.builtin is None) == (self.urdf is None):
            raise ValueError("exactly one of builtin and urdf")
        return self

    def build(self, beside: Path) -> Machine:
        """The machine at its place.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError, MachineError: a URDF, a link or a pose that is not usable.
        """
        base = None if self.world_from_base is None else np.array(self.world_from_base)
        if self.builtin is not None:
            machine = ceiling_c_arm(base)
            unchecked = dict.fromkeys((*machine.unchecked_links, *self.unchecked_links))
            return replace(machine, unchecked_links=tuple(unchecked))
        urdf = expand(str(self.urdf), beside)
        return Machine.from_urdf(urdf, world_from_base=base, unchecked_links=self.unchecked_links)


class JointEntry(Entry):
    """Full speed of a joint, in metres or degrees a second, and the time in which it brakes from it."""

    max_speed_m_s: Annotated[Positive, up_to(20, "m/s", MM_A_SECOND)] | None = None
    max_speed_deg_s: Annotated[Positive, up_to(5000, "degrees a second")] | None = None
    braking_time_s: Annotated[Positive, up_to(60, "s", MILLISECONDS)]

    @model_validator(mode="after")
    def _one_speed(self) -> "JointEntry":
        if (self.max_speed_m_s is None) == (self.max_speed_deg_s is None):
            raise ValueError("exactly one of max_speed_m_s (prismatic) and max_speed_deg_s (revolute)")
        return self

    def speed_of(self, joint: Joint) -> float:
        """Full speed [m/s or rad/s].

        Raises:
            SiteError: it is given in the unit of another kind of joint.
        """
        if joint.unit == "m" and self.max_speed_m_s is not None:
            return self.max_speed_m_s
        if joint.unit == "rad" and self.max_speed_deg_s is not None:
            return math.radians(self.max_speed_deg_s)
        does, key = ("slides", "max_speed_m_s") if joint.unit == "m" else ("turns", "max_speed_deg_s")
        raise SiteError(f"joints.{joint.name}: {joint.name} {does}, its speed is written {key}")


def motions_of(machine: Machine, joints: Mapping[str, JointEntry]) -> tuple[Motion, ...]:
    """Each joint that has a speed, in both directions, in the order of the machine.

    Args:
        machine: whose joints they are.
        joints: entries by name of the joint.

    Raises:
        SiteError: a joint that the machine does not have, or a speed in the unit of another kind of joint.
    """
    for name in joints:
        if name not in machine.joint_names:
            known = ", ".join(machine.joint_names) or "none"
            raise SiteError(f"joints.{name}: unknown joint; joints of {machine.name} are {known}")
    distances = {
        name: braking_distance(joints[name].speed_of(machine.joint(name)), joints[name].braking_time_s)
        for name in machine.joint_names
        if name in joints
    }
    return tuple(Motion(name, way, distance) for name, distance in distances.items() for way in (+1, -1))
