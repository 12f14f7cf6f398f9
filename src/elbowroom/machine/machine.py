"""The machine: links with a body, joints that move them, and where the links are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.free_joint import FreeKind, Skeleton, free_positions, on_free_base
from elbowroom.machine.joint import Joint
from elbowroom.machine.kernels.body import Tree, place_links
from elbowroom.machine.link import Link
from elbowroom.machine.shape import Shape

LIMIT_TOLERANCE = 1e-6
"""Joint positions beyond a limit by this much are rounding, not a fault [m or rad]."""

Joints = Mapping[str, ArrayLike]
"""Joint positions by name [m or rad]: numbers, or arrays of one length n for n configurations."""


@dataclass(frozen=True, eq=False)
class Machine:
    """A machine at a place. Made by `Machine.from_urdf`; never changes. `at` says it of another place.

    Args:
        name: of the robot in the URDF.
        links: all links, parents before their children, with or without geometry; arrays of links use this
            order.
        joints: joints that move, in the order of the links that they carry, followers (mimic) among them.
        tree: parents, fixed transforms and axes by link, as the kernels take them.
        world_from_base: where the first link is, shape (4, 4), rigid.
        unchecked_links: links that may leave the grid by design and are not checked for collision.

    Raises:
        MachineError: `world_from_base` is not rigid, or an unchecked link does not exist.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree = field(repr=False)
    world_from_base: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    unchecked_links: tuple[str, ...] = ()
    shape: Shape = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", Shape.of(self.links))
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
    ) -> "Machine":
        """Reads a URDF with its collision geometry: meshes (STL, OBJ, GLB, PLY), boxes, cylinders, spheres.

        A link without collision geometry takes its visual geometry if that exists. Cylinders and spheres
        become polyhedra that contain them.

        Args:
            path: the URDF file.
            world_from_base: where its first link is, shape (4, 4), rigid; None: at the world's origin.
            unchecked_links: names of links that leave the grid by design.
            package_dirs: where to look for `package://` files, before the folders above the URDF.

        Raises:
            MachineError: the file, one of its meshes or its tree of links cannot be used; the message says
                which.
        """
        # what reads meshes is slow to load, and a bare room needs none of it
        from elbowroom.machine.urdf import read_urdf

        parts = read_urdf(Path(path), [Path(folder) for folder in package_dirs])
        base = np.eye(4) if world_from_base is None else np.asarray(world_from_base, dtype=np.float64)
        return cls(*parts, world_from_base=base, unchecked_links=tuple(unchecked_links))

    def at(self, world_from_base: ArrayLike) -> "Machine":
        """The same machine with its base elsewhere. What was made of its links is shared, so it costs next to nothing.

        Args:
            world_from_base: where its first link is, shape (4, 4), rigid.

        Raises:
            MachineError: the pose is not rigid.
        """
        return replace(self, world_from_base=np.asarray(world_from_base, dtype=np.float64))

    def with_free_base(self, kind: FreeKind, name: str = "base") -> "Machine":
        """The machine on a base that moves: where it stands is then among its joint positions, at each frame's time.

        Args:
            kind: "planar": joints `base/x`, `base/y` [m] and `base/yaw` [rad], as a platform drives in the plane of
                `world_from_base`; "floating": `base/x`, `base/y`, `base/z`, `base/yaw`, `base/pitch`, `base/roll`, of
                which nobody asks a motion.
            name: instead of `base`.

        Raises:
            MachineError: a name that is taken.
        """
        return replace(
            self, **on_free_base(Skeleton(self.links, self.joints, self.tree), kind, name)._asdict()
        )

    def free_positions(self, joint: str, parent_from_child: ArrayLike) -> dict[str, float]:
        """The positions that put the link of a planar or floating joint at a pose, by name [m or rad].

        Args:
            joint: its name, such as `base`.
            parent_from_child: where its link is in the one before, shape (4, 4), rigid.

        Raises:
            MachineError: no such joint, a pose that is not rigid, or one out of the plane of a planar joint.
        """
        return free_positions(Skeleton(self.links, self.joints, self.tree), joint, parent_from_child)

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

    def checked(self, joints: Joints) -> dict[str, NDArray[np.float64]]:
        """The same joint positions, in the order of `joint_names`, after finding them possible.

        Args:
            joints: positions by name, numbers or arrays [m or rad].

        Returns:
            float64 arrays of the shapes that came.

        Raises:
            MachineError: an unknown or a missing joint, a value that is not finite or out of the joint's
                limits.
        """
        for name in joints:
            self.joint(name)
        found = {}
        for name in self.joint_names:
            joint = self.joint(name)
            if name not in joints:
                raise MachineError(
                    f"machine {self.name}: joint {name!r} has no position; all joints need one"
                )
            try:
                values = np.asarray(joints[name], dtype=np.float64)
            except (TypeError, ValueError):
                raise MachineError(f"joint {name}: {joints[name]!r} is not a number [{joint.unit}]") from None
            if not np.isfinite(values).all():
                raise MachineError(
                    f"joint {name}: position is not finite, got {joints[name]!r} [{joint.unit}]"
                )
            beyond = (values < joint.lower - LIMIT_TOLERANCE) | (values > joint.upper + LIMIT_TOLERANCE)
            if beyond.any():
                raise MachineError(
                    f"joint {name}: {values[beyond].flat[0]:g} {joint.unit} is out of its limits, "
                    f"{joint.lower:g} to {joint.upper:g} {joint.unit}"
                )
            found[name] = values
        return found

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
