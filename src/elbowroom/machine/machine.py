"""The machine: links with a body, joints that move them, and where the links are."""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError, MachineWarning
from elbowroom.finding import Finding
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.joint import Joint
from elbowroom.machine.kernels.body import Tree, place_links
from elbowroom.machine.link import Link

ROUNDING = 1e-6
"""Positions beyond a limit by this much are rounding, not a fault [m or rad]."""
QUIET = ("package", "limits", "axes")
"""Kinds of findings that are kept with the machine, and are no slip that a warning is due for."""


class Tolerance(NamedTuple):
    """How far a joint may be said to be where it cannot be: encoders and descriptions differ by little.

    Args:
        rad: for joints that turn [rad].
        m: for joints that slide [m].
    """

    rad: float = float(np.radians(1.0))
    m: float = 0.005

    def of(self, unit: str) -> float:
        """For joints of a unit, "rad" or "m"; never less than rounding."""
        return max(self.m if unit == "m" else self.rad, ROUNDING)


Joints = Mapping[str, ArrayLike]
"""Joint positions by name [m or rad]: numbers, or arrays of one length n for n configurations."""


@dataclass(frozen=True, eq=False)
class Machine:
    """A machine at a fixed place. Made by `Machine.from_urdf`; never changes.

    Args:
        name: of the robot in the URDF.
        links: all links, parents before their children, with or without geometry; arrays of links use this
            order.
        joints: joints that move, in the order of the links that they carry, followers (mimic) among them.
        tree: parents, fixed transforms and axes by link, as the kernels take them.
        world_from_base: where the first link is, shape (4, 4), rigid.
        unchecked_links: links that may leave the grid by design and are not checked for collision.
        bodiless_links: links whose geometry was left out by somebody's word: they move without a body.
        tolerance: how far a position may lie beyond a limit, and a follower off its leader.
        findings: what was found in its description and passed, each in one line.

    Raises:
        MachineError: `world_from_base` is not rigid, or an unchecked link does not exist.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree = field(repr=False)
    world_from_base: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    unchecked_links: tuple[str, ...] = ()
    bodiless_links: tuple[str, ...] = ()
    tolerance: Tolerance = field(default_factory=Tolerance)
    findings: tuple[Finding, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        what = f"machine {self.name}"
        base = nearest_rigid(self.world_from_base, f"{what}: world_from_base", MachineError)
        base.setflags(write=False)
        object.__setattr__(self, "world_from_base", base)
        object.__setattr__(self, "unchecked_links", tuple(self.unchecked_links))
        for name in self.unchecked_links:
            if name not in self.link_names:
                raise MachineError(
                    f"{what}: unchecked link {name!r} does not exist; links are {', '.join(self.link_names)}"
                )

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        *,
        world_from_base: ArrayLike | None = None,
        unchecked_links: Sequence[str] = (),
        package_dirs: Sequence[str | Path] = (),
        without_body: Sequence[str] = (),
        xacro_arguments: Mapping[str, str] | None = None,
        largest_link_m: float | None = None,
    ) -> "Machine":
        """Reads a URDF with its collision geometry: meshes (STL, OBJ, PLY, GLB, glTF, Collada), boxes, round solids.

        A link without collision geometry takes its visual geometry. Cylinders, spheres and capsules become polyhedra
        that contain them. Where a joint has followers (mimic), its limits end where the first of them ends. A file that
        is xacro is expanded, where the package xacro is installed.

        Args:
            path: the URDF file.
            world_from_base: where its first link is, shape (4, 4), rigid; None: at the world's origin.
            unchecked_links: names of links that leave the grid by design.
            package_dirs: where to look for `package://` files, before the folders above the URDF and where ROS keeps
                packages (ROS_PACKAGE_PATH, AMENT_PREFIX_PATH).
            without_body: names of links that move without a body: their geometry is not read.
            xacro_arguments: values of the arguments of a xacro file, by name.
            largest_link_m: a longer link is refused [m]; None: 20 m, and meshes out of all proportion.

        Raises:
            MachineError: the file, one of its meshes or its tree of links cannot be used; the message says
                which, and where in the file.

        Warns:
            MachineWarning: a slip that passes.
        """
        # what reads meshes is slow to load, and a bare room needs none of it
        from elbowroom.machine.urdf import Reading, read_urdf

        folders = [Path(folder) for folder in package_dirs]
        reading = Reading(folders, without_body, xacro_arguments or {}, largest_link_m)
        parts = read_urdf(Path(path), reading)
        for finding in parts.findings:
            if finding.kind not in QUIET:
                warnings.warn(finding.text, MachineWarning, stacklevel=2)
        return cls(
            **parts._asdict(),
            world_from_base=np.eye(4) if world_from_base is None else np.asarray(world_from_base, float),
            unchecked_links=tuple(unchecked_links),
            bodiless_links=tuple(without_body),
        )

    @cached_property
    def link_names(self) -> tuple[str, ...]:
        """Names of all links, in the order of `links`."""
        return tuple(link.name for link in self.links)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints that are commanded, in tree order; followers are left out."""
        return tuple(joint.name for joint in self.joints if joint.mimic is None)

    @cached_property
    def checked_links(self) -> tuple[str, ...]:
        """Names of the links that have geometry and are not in `unchecked_links`."""
        return tuple(
            link.name for link in self.links if link.has_geometry and link.name not in self.unchecked_links
        )

    def joint(self, name: str) -> Joint:
        """The commanded joint of this name.

        Raises:
            MachineError: there is none; the message lists those that exist.
        """
        for joint in self.joints:
            if joint.name == name and joint.mimic is None:
                return joint
        raise MachineError(
            f"machine {self.name}: no joint {name!r}; joints are {', '.join(self.joint_names) or 'none'}"
        )

    def moved_links(self, joint: str) -> tuple[str, ...]:
        """Names of the links that move with a joint or with its followers, with or without geometry.

        Raises:
            MachineError: no such joint.
        """
        column = self.joint_names.index(self.joint(joint).name)
        moved = np.zeros(len(self.links), dtype=bool)
        for row, parent in enumerate(self.tree.parent):
            moved[row] = self.tree.column[row] == column or (parent >= 0 and moved[parent])
        return tuple(name for name, moves in zip(self.link_names, moved, strict=True) if moves)

    def nearest_to_zero(self) -> dict[str, float]:
        """All joints at zero, or at the limit nearest to it [m or rad]."""
        joints = [self.joint(name) for name in self.joint_names]
        return {joint.name: min(max(0.0, joint.lower), joint.upper) for joint in joints}

    def require_joints(self, names: Iterable[str]) -> None:
        """Refuses names that are no joints of this machine.

        Raises:
            MachineError: one that is neither commanded nor a follower; the message lists those that exist.
        """
        followers = {joint.name for joint in self.joints if joint.mimic is not None}
        for name in names:
            if name not in followers:
                self.joint(name)

    def checked(self, joints: Joints) -> dict[str, NDArray[np.float64]]:
        """The same joint positions, in the order of `joint_names`, after finding them possible.

        Whole joint states are taken: followers are compared with the joints that they follow, and names that the
        machine does not have belong to other machines, and pass. A position beyond a limit by less than `tolerance`
        is taken as it is.

        Args:
            joints: positions by name, numbers or arrays [m or rad].

        Returns:
            float64 arrays of the shapes that came.

        Raises:
            MachineError: a missing joint, a value that is not finite or out of the joint's limits, a follower that is
                not where its leader puts it.
        """
        found = {}
        for name in self.joint_names:
            joint = self.joint(name)
            if name not in joints:
                raise MachineError(
                    f"machine {self.name}: joint {name!r} has no position; all joints need one"
                )
            values = _finite(joint, joints[name])
            over = self.tolerance.of(joint.unit)
            beyond = (values < joint.lower - over) | (values > joint.upper + over)
            if beyond.any():
                raise MachineError(
                    f"joint {name}: {values[beyond].flat[0]:g} {joint.unit} is out of its limits, "
                    f"{joint.lower:g} to {joint.upper:g} {joint.unit}"
                )
            found[name] = values
        self._require_followers(joints, found)
        return found

    def _require_followers(self, joints: Joints, found: Mapping[str, NDArray[np.float64]]) -> None:
        """Refuses followers that are said to be elsewhere than the joints that they follow put them."""
        for follower in self.joints:
            if follower.mimic is None or follower.name not in joints:
                continue
            values, row = _finite(follower, joints[follower.name]), self.link_names.index(follower.child)
            leader = self.joint_names[self.tree.column[row]]
            expected = self.tree.multiplier[row] * found[leader] + self.tree.offset[row]
            if values.ndim and expected.ndim and values.shape != expected.shape:
                raise MachineError(
                    f"machine {self.name}: joint arrays of unlike lengths: {leader} {expected.size}, "
                    f"{follower.name} {values.size}"
                )
            values, expected = np.broadcast_arrays(values, expected)
            off = np.abs(values - expected) > self.tolerance.of(follower.unit)
            if off.any():
                raise MachineError(
                    f"joint {follower.name}: {values[off].flat[0]:g} {follower.unit}, but it follows {leader}, which "
                    f"puts it at {expected[off].flat[0]:g} {follower.unit}; the machine is not as its description says"
                )

    def positions(self, joints: Joints) -> NDArray[np.float64]:
        """Checked joint positions as one array, shape (n_joints,) or (n, n_joints), columns as `joint_names`.

        Raises:
            MachineError: as `checked`, or arrays of unlike lengths.
        """
        values = list(self.checked(joints).values())
        if any(value.ndim > 1 for value in values):
            raise MachineError(
                f"machine {self.name}: joint positions must be numbers or arrays of one dimension"
            )
        try:
            return np.stack(np.broadcast_arrays(*values), axis=-1) if values else np.zeros(0)
        except ValueError:
            lengths = {name: value.size for name, value in zip(self.joint_names, values, strict=True)}
            raise MachineError(f"machine {self.name}: joint arrays of unlike lengths {lengths}") from None

    def world_from_links(self, joints: Joints) -> dict[str, NDArray[np.float64]]:
        """Where all links are.

        Args:
            joints: positions by name [m or rad], numbers or arrays of one length n.

        Returns:
            By link name: shape (4, 4), or (n, 4, 4) if any position is an array.

        Raises:
            MachineError: as `positions`.
        """
        positions = self.positions(joints)
        placed = self.world_from_link_array(np.atleast_2d(positions))
        if positions.ndim == 1:
            placed = placed[0]
        return {name: placed[..., row, :, :] for row, name in enumerate(self.link_names)}

    def world_from_link_array(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where all links are, for many configurations at once: 1 ms for a thousand of a six-axis arm.

        Limits are not looked at: a sweep may ask for what lies beyond them.

        Args:
            positions: shape (n, n_joints) [m or rad], columns as `joint_names`.

        Returns:
            float64, shape (n, n_links, 4, 4), rows as `links`.

        Raises:
            MachineError: another shape, or a position that is not finite.
        """
        given = np.ascontiguousarray(positions, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != len(self.joint_names):
            raise MachineError(
                f"machine {self.name}: positions must have shape (n, {len(self.joint_names)}), "
                f"got {given.shape}"
            )
        if not np.isfinite(given).all():
            raise MachineError(f"machine {self.name}: joint positions must be finite")
        placed = np.empty((len(given), len(self.links), 4, 4))
        place_links(self.tree, self.world_from_base, given, placed)
        return placed


def _finite(joint: Joint, given: ArrayLike) -> NDArray[np.float64]:
    """A joint's positions as numbers [m or rad]."""
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise MachineError(f"joint {joint.name}: {given!r} is not a number [{joint.unit}]") from None
    if not np.isfinite(values).all():
        raise MachineError(f"joint {joint.name}: position is not finite, got {given!r} [{joint.unit}]")
    return values
