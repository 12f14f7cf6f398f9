"""The machine and the speeds of its joints as a site file describes them."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from elbowroom.choices import ExplainWith
from elbowroom.errors import MachineWarning, SiteError
from elbowroom.machine import Joint, Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.machine.joint_state import JointTolerance
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.together import Member
from elbowroom.motion import Braking, Motion, Override, braking_distance
from elbowroom.motion.creep import REDUCED_SPEED_M_S, SHARE_OF_FULL_SPEED
from elbowroom.site.contact_entry import ContactEntry, PartEntry, StandEntry, require_protected
from elbowroom.site.entry import Entry, Flag, Matrix, NotNegative, Number, Positive, Text
from elbowroom.site.paths import existing_folder, expand
from elbowroom.site.ranges import MILLIMETRES, MILLISECONDS, MM_A_SECOND, up_to

OF_A_URDF = ("package_dirs", "xacro_arguments", "without_body", "largest_link_m", "explain_with")
"""Keys that say how a URDF is read."""


class MachineEntry(Entry):
    """The machine: one that ships with the package, or a URDF; where its base stands; links not to check.

    `explain_tolerance_m` is how far from its model a measured point may lie and still be the machine itself, and
    `explain_with` says which geometry that model is. `allowed_contacts` are pairs of links that may touch; `own_links`
    or `srdf` is a file that names pairs that are not compared. `stands_on` are boxes of the room that some links may
    touch, `contacts` fixed things that some may be near, `carries` parts that it holds. `limit_tolerance_deg` and
    `limit_tolerance_mm` are how far a joint may be said to be beyond a limit, `package_dirs` folders of packages,
    `without_body` links whose geometry is left out.
    On a `free_base` the machine drives or floats, and where it stands is among its joint positions.
    """

    builtin: Literal["ceiling_c_arm"] | None = None
    urdf: Text | None = None
    world_from_base: Matrix | None = None
    unchecked_links: tuple[Text, ...] = ()
    explain_tolerance_m: Annotated[Positive, up_to(0.5, "m", MILLIMETRES)] | None = None
    explain_with: ExplainWith = "auto"
    allowed_contacts: tuple[tuple[Text, Text], ...] = ()
    own_links: Text | None = None
    srdf: Text | None = None
    stands_on: tuple[StandEntry, ...] = ()
    contacts: tuple[ContactEntry, ...] = ()
    carries: tuple[PartEntry, ...] = ()
    free_base: Literal["planar", "floating"] | None = None
    package_dirs: tuple[Text, ...] = ()
    xacro_arguments: dict[Text, Text | Number | Flag] = Field(default_factory=dict)
    without_body: tuple[Text, ...] = ()
    largest_link_m: Positive | None = None
    limit_tolerance_deg: Annotated[NotNegative, up_to(90, "degrees")] | None = None
    limit_tolerance_mm: Annotated[NotNegative, up_to(1000, "mm")] | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "MachineEntry":
        if (self.builtin is None) == (self.urdf is None):
            raise ValueError("exactly one of builtin and urdf")
        own = sorted(self.model_fields_set & set(OF_A_URDF))
        if self.builtin is not None and own:
            raise ValueError(f"{own[0]} only with urdf")
        if self.own_links is not None and self.srdf is not None:
            raise ValueError("either own_links or srdf, not both")
        return self

    @property
    def tolerance(self) -> JointTolerance:
        """How far a joint may be said to be where it cannot be."""
        usual = JointTolerance()
        return JointTolerance(
            usual.rad if self.limit_tolerance_deg is None else math.radians(self.limit_tolerance_deg),
            usual.m if self.limit_tolerance_mm is None else self.limit_tolerance_mm / 1e3,
        )

    def build(self, beside: Path) -> Machine:
        """The machine at its place.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError, MachineError: a URDF, a link or a pose that is not usable.
        """
        machine = self._bare(beside)
        for part in self.carries:
            machine = part.on(machine, beside)
        # parts are links that the file may name
        machine = machine.comparing(self._own_links(beside))
        machine = machine.allowing(*self.allowed_contacts)
        machine = machine.standing_on(*(stand.build() for stand in self.stands_on))
        machine = machine.near(*(contact.build(beside) for contact in self.contacts))
        require_protected(machine)
        return machine

    def standing(self, beside: Path) -> Machine:
        """The machine at its place, on its free base if it has one.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError, MachineError: as `build`.
        """
        machine = self.build(beside)
        return machine if self.free_base is None else machine.with_free_base(self.free_base)

    def _own_links(self, beside: Path) -> OwnLinks | None:
        if self.own_links is not None:
            return OwnLinks.from_yaml(expand(self.own_links, beside))
        return None if self.srdf is None else OwnLinks.from_srdf(expand(self.srdf, beside))

    def _bare(self, beside: Path) -> Machine:
        base = None if self.world_from_base is None else np.array(self.world_from_base)
        if self.builtin is not None:
            machine = ceiling_c_arm(base)
            unchecked = dict.fromkeys((*machine.unchecked_links, *self.unchecked_links))
            return replace(machine, unchecked_links=tuple(unchecked), tolerance=self.tolerance)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MachineWarning)  # the notes on the site say them
            machine = Machine.from_urdf(
                expand(str(self.urdf), beside),
                world_from_base=base,
                unchecked_links=self.unchecked_links,
                package_dirs=[existing_folder(folder, beside) for folder in self.package_dirs],
                without_body=self.without_body,
                xacro_arguments={name: _as_xacro(value) for name, value in self.xacro_arguments.items()},
                largest_link_m=self.largest_link_m,
                explain_with=self.explain_with,
            )
        return replace(machine, tolerance=self.tolerance)


class MemberEntry(MachineEntry):
    """One of several machines: its name stands before its links', its `joint_prefix` before its joints'."""

    name: Annotated[Text, Field(pattern=r"^[^/*?\[\]]+$")]
    joint_prefix: Annotated[str, Field(max_length=1000)] = ""

    def member(self, beside: Path) -> Member:
        """The machine at its place, with its name.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError, MachineError: as `build`.
        """
        return Member(self.name, self.standing(beside), self.joint_prefix)


def _as_xacro(value: str | float | bool) -> str:
    """A value as xacro writes it: true and false in small letters, whole numbers without a point."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


class JointEntry(Entry):
    """Full speed of a joint, in metres or degrees a second, the time in which it brakes from it, and what shall be left
    of its way where it rests."""

    max_speed_m_s: Annotated[Positive, up_to(20, "m/s", MM_A_SECOND)] | None = None
    max_speed_deg_s: Annotated[Positive, up_to(5000, "degrees a second")] | None = None
    braking_time_s: Annotated[Positive, up_to(60, "s", MILLISECONDS)]
    clearance_mm: Annotated[NotNegative, up_to(5000, "mm")] | None = None
    clearance_deg: Annotated[NotNegative, up_to(360, "degrees")] | None = None

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

    def clearance_of(self, joint: Joint) -> float:
        """What shall be left of the way [m or rad].

        Raises:
            SiteError: it is given in the unit of another kind of joint.
        """
        own, other = (
            (self.clearance_mm, self.clearance_deg)
            if joint.unit == "m"
            else (self.clearance_deg, self.clearance_mm)
        )
        if other is not None:
            key = "clearance_mm" if joint.unit == "m" else "clearance_deg"
            raise SiteError(f"joints.{joint.name}: the clearance of {joint.name} is written {key}")
        return 0.0 if own is None else own / 1e3 if joint.unit == "m" else math.radians(own)


class OverrideEntry(Entry):
    """How fast an operator who holds on may creep where nobody sees: of the fastest point, and of full speed."""

    max_speed_mm_s: Annotated[Positive, up_to(1000, "mm/s")] = 1e3 * REDUCED_SPEED_M_S
    share_of_full_speed: Annotated[Number, Field(gt=0, le=1)] = SHARE_OF_FULL_SPEED

    def build(self, speeds: Mapping[str, float]) -> Override:
        """The override.

        Args:
            speeds: full speeds of the joints by name [m/s or rad/s].
        """
        return Override(self.max_speed_mm_s / 1e3, self.share_of_full_speed, speeds)


class StoppingEntry(Entry):
    """How the machine stops: how long it goes on before it brakes, and whether it leaves its path then."""

    reaction_time_ms: Annotated[NotNegative, up_to(10_000, "ms")] = 0.0
    leaves_path: Flag = True


def motions_of(
    machine: Machine, joints: Mapping[str, JointEntry], reaction_time_s: float = 0.0
) -> tuple[Motion, ...]:
    """Each joint that has a speed, in both directions, in the order of the machine.

    Args:
        machine: whose joints they are.
        joints: entries by name of the joint.
        reaction_time_s: before it brakes, as far as braking times do not hold it [s].

    Raises:
        SiteError: a joint that the machine does not have, or a speed in the unit of another kind of joint.
    """
    _require_known(machine, joints)
    motions = []
    for name in machine.joint_names:
        if name in joints:
            entry, joint = joints[name], machine.joint(name)
            speed = entry.speed_of(joint)
            brakes, goes_on = braking_distance(speed, entry.braking_time_s), speed * reaction_time_s
            clearance = entry.clearance_of(joint)
            motions += [Motion(name, way, brakes, None, goes_on, clearance) for way in (+1, -1)]
    return tuple(motions)


def braking_of(machine: Machine, joints: Mapping[str, JointEntry], stopping: StoppingEntry) -> Braking:
    """How the joints that have a speed come to rest.

    Args:
        machine: whose joints they are.
        joints: entries by name of the joint.
        stopping: of the whole machine.

    Raises:
        SiteError: as `motions_of`.
    """
    _require_known(machine, joints)
    return Braking(
        {name: entry.speed_of(machine.joint(name)) for name, entry in joints.items()},
        {name: entry.braking_time_s for name, entry in joints.items()},
        stopping.reaction_time_ms / 1e3,
        stopping.leaves_path,
    )


def _require_known(machine: Machine, joints: Mapping[str, JointEntry]) -> None:
    for name in joints:
        if name not in machine.joint_names:
            known = ", ".join(machine.joint_names) or "none"
            leader = machine.leader_of(name)
            if leader is not None:
                raise SiteError(
                    f"joints.{name}: follows {leader} (mimic) and has no speed of its own; name {leader}"
                )
            raise SiteError(f"joints.{name}: unknown joint; joints of {machine.name} are {known}")
