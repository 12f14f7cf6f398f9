"""The machine: links with a body, joints that move them, and where the links are."""

import warnings
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.choices import ExplainWith
from elbowroom.errors import MachineError, MachineWarning
from elbowroom.finding import Finding
from elbowroom.geometry import nearest_rigid
from elbowroom.machine import branch
from elbowroom.machine.carried import require_beside, require_size
from elbowroom.machine.contact import Contact
from elbowroom.machine.free_joint import FreeKind, Skeleton, free_positions, on_free_base
from elbowroom.machine.joint import Joint
from elbowroom.machine.joint_state import (
    Follower,
    Joints,
    JointTolerance,
    followers_of,
    possible_positions,
    require_followers,
)
from elbowroom.machine.kernels.body import Tree, place_links
from elbowroom.machine.link import Link
from elbowroom.machine.names import named_by
from elbowroom.machine.overlap import POSES, always_touching
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.part import Part
from elbowroom.machine.poses import random_poses
from elbowroom.machine.shape import Shape
from elbowroom.machine.stand import Stand
from elbowroom.machine.zone import Zone

QUIET = ("package", "limits", "axes", "larger")
"""Kinds of findings that are kept with the machine, and are no slip that a warning is due for."""


_anywhere: WeakValueDictionary[tuple[Hashable, ...], "Machine"] = WeakValueDictionary()
"""By all but their place, the first of the machines that are alike."""


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
        allowed_contacts: pairs of names of links that may touch, besides neighbours; a name may hold wildcards ("*").
        own_links: pairs of links that are not compared, and the file that says so; None: none is named.
        stands: what some links may touch: a table, the floor.
        contacts: fixed things that some links may be near.
        zones: where a person says that links must not be, or that nobody watches.
        parts: names of the links that are carried (`with_part`).
        bodiless_links: links whose geometry was left out by somebody's word: they move without a body.
        tolerance: how far a position may lie beyond a limit, and a follower off its leader.
        findings: what was found in its description and passed, each in one line.

    Raises:
        MachineError: `world_from_base` is not rigid, or a link that is named does not exist.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree = field(repr=False)
    world_from_base: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    unchecked_links: tuple[str, ...] = ()
    allowed_contacts: tuple[tuple[str, str], ...] = ()
    own_links: OwnLinks | None = None
    stands: tuple[Stand, ...] = ()
    contacts: tuple[Contact, ...] = ()
    zones: tuple[Zone, ...] = ()
    parts: tuple[str, ...] = ()
    bodiless_links: tuple[str, ...] = ()
    tolerance: JointTolerance = field(default_factory=JointTolerance)
    findings: tuple[Finding, ...] = field(default=(), repr=False)
    shape: Shape = field(init=False, repr=False)
    _elsewhere: "Machine | None" = field(init=False, repr=False)

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
        object.__setattr__(self, "allowed_contacts", tuple((a, b) for a, b in self.allowed_contacts))
        object.__setattr__(self, "stands", tuple(self.stands))
        for stand in self.stands:
            self._require_links("stands_on", stand.links)
        object.__setattr__(self, "contacts", tuple(self.contacts))
        for contact in self.contacts:
            self._require_links(f"contacts: {contact.name}", contact.links)
        object.__setattr__(self, "zones", tuple(self.zones))
        for zone in self.zones:
            self._require_links(f"zones: {zone.name}", zone.links)
        if self.own_links is not None:
            object.__setattr__(self, "own_links", self.own_links.among(self.link_names))
        for pair in self.allowed_contacts:
            self._require_links("allowed_contacts", pair)
        first = _anywhere.setdefault(self._all_but_place(), self)
        object.__setattr__(self, "_elsewhere", None if first is self else first)

    def _all_but_place(self) -> tuple[Hashable, ...]:
        """What machines have in common that differ by their place alone."""
        own = (
            tuple(map(id, values))
            for values in (self.links, self.joints, self.stands, self.zones, self.findings)
        )
        # things of contacts stand in the world, wherever the machine does
        things = (*map(id, self.contacts), self.world_from_base.tobytes() if self.contacts else b"")
        named = things, self.unchecked_links, self.allowed_contacts, self.parts, self.bodiless_links
        return self.name, id(self.tree), id(self.own_links), *own, *named, self.tolerance

    @property
    def anywhere(self) -> "Machine":
        """The machine that stands for all that differ from it by their place alone.

        What does not depend on the place is kept with it (`geometry.kept`).
        """
        return self if self._elsewhere is None else self._elsewhere

    def _require_links(self, what: str, names: Sequence[str]) -> None:
        """Each name, which may hold wildcards, is that of a link."""
        for name in names:
            found = named_by(name, self.link_names)
            if not found:
                raise MachineError(
                    f"machine {self.name}: {what}: link {name!r} does not exist; links are "
                    f"{', '.join(self.link_names)}"
                )
            if name in found and len(found) > 1:
                others = ", ".join(link for link in found if link != name)
                raise MachineError(
                    f"machine {self.name}: {what}: {name!r} is a link, and stands for {others} as well by its "
                    "wildcards; rename it"
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
        explain_with: ExplainWith = "auto",
    ) -> "Machine":
        """Reads a URDF with its collision geometry: meshes (STL, OBJ, PLY, GLB, glTF, Collada), boxes, round solids.

        A link without collision geometry takes its visual geometry. Cylinders, spheres and capsules become polyhedra
        that contain them. Where a joint has followers (mimic), its limits end where the first of them ends. A file that
        is xacro is expanded, where the package xacro is installed.

        Collision geometry is what a motion is swept with. It may be larger than the machine, so what cameras see of
        it may be another surface, within it.

        Args:
            path: the URDF file.
            world_from_base: where its first link is, shape (4, 4), rigid; None: at the world's origin.
            unchecked_links: names of links that leave the grid by design.
            package_dirs: where to look for `package://` files, before the folders above the URDF and where ROS keeps
                packages (ROS_PACKAGE_PATH, AMENT_PREFIX_PATH).
            without_body: names of links that move without a body: their geometry is not read.
            xacro_arguments: values of the arguments of a xacro file, by name.
            largest_link_m: a longer link is refused [m]; None: 20 m, and meshes out of all proportion.
            explain_with: which geometry says what cameras see of a link. "auto": its visual geometry, if all of it can
                be read and it fills the collision geometry without standing out of it; else the collision geometry.
                "visual": visual geometry wherever a link has any. "collision": never.

        Raises:
            MachineError: the file, one of its meshes or its tree of links cannot be used; the message says
                which, and where in the file.

        Warns:
            MachineWarning: a slip that passes.
        """
        # what reads meshes is slow to load, and a bare room needs none of it
        from elbowroom.machine.urdf import Reading, read_urdf

        folders = [Path(folder) for folder in package_dirs]
        reading = Reading(folders, without_body, xacro_arguments or {}, largest_link_m, explain_with)
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

    @cached_property
    def as_seen(self) -> "Machine":
        """The machine with what cameras see of its links for a body; itself, where that is its collision geometry."""
        if all(link.seen is None for link in self.links):
            return self
        return replace(self, links=tuple(link.as_seen for link in self.links))

    def standing_on(self, *stands: Stand) -> "Machine":
        """The machine with boxes of the room that some of its links may touch; those that it has stay.

        Raises:
            MachineError: a link that is named does not exist.
        """
        return replace(self, stands=(*self.stands, *stands))

    def near(self, *contacts: Contact) -> "Machine":
        """The machine with fixed things of the room that some of its links may be near; those that it has stay.

        Raises:
            MachineError: a link that is named does not exist, or a thing of a name that is taken.
        """
        names = [contact.name for contact in (*self.contacts, *contacts)] + list(self.link_names)
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise MachineError(f"contacts: the name {doubled[0]} is there more than once, or that of a link")
        return replace(self, contacts=(*self.contacts, *contacts))

    def with_zones(self, *zones: Zone) -> "Machine":
        """The machine with zones of the room that a person declares; those that it has stay.

        Raises:
            MachineError: a link that is named does not exist, or two zones of one name.
        """
        names = [zone.name for zone in (*self.zones, *zones)]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise MachineError(f"zones: {doubled[0]} is there more than once; each needs a name of its own")
        return replace(self, zones=(*self.zones, *zones))

    def allowing(self, *contacts: tuple[str, str]) -> "Machine":
        """The machine with pairs of links that may touch; those that it has stay. Names may hold wildcards.

        Raises:
            MachineError: a link that is named does not exist.
        """
        return replace(self, allowed_contacts=(*self.allowed_contacts, *contacts))

    def comparing(self, own_links: OwnLinks | None) -> "Machine":
        """The machine with the pairs of links that are not compared; those that it had are replaced.

        Raises:
            MachineError: a link that is named does not exist.
        """
        return replace(self, own_links=own_links)

    @cached_property
    def allowances(self) -> tuple[str, ...]:
        """What somebody's word lets pass, a line each: every summary says it."""
        return (
            *map(str, self.zones),
            *map(str, self.contacts),
            *(f"Not stopped by anything there, by the site's word: {stand}" for stand in self.stands),
            *(
                f"May touch each other, {self._why_allowed(one, other)}: {one} and {other}"
                for one, other in self.allowed_contacts
            ),
            *(() if self.own_links is None else (self.own_links.said,)),
        )

    def _why_allowed(self, one: str, other: str) -> str:
        """Whose word lets links touch; with what a link carries, it may be that they nearly always do."""
        return (
            "as nearly always or by the site's word"
            if {one, other} & set(self.parts)
            else "by the site's word"
        )

    def with_part(self, link: str, part: Part, link_from_part: ArrayLike | None = None) -> "Machine":
        """The machine with a part on one of its links, as a link of its own: explained, taken out and swept with it.

        The part may touch its link and what is fixed to that; of the moving links that hang on these, those that touch
        it in nearly all poses, which is then among `allowed_contacts`. Fingers that hold it are compared with it,
        unless they are allowed to touch it (`allowing`): those that touch it already may go deeper by what is in doubt
        about how deep they are, and thin ones are not ended by it.

        Args:
            link: name of the link that carries it.
            part: what it carries.
            link_from_part: where the part is on it, shape (4, 4), rigid; None: frames are one.

        Raises:
            MachineError: no such link, a link of the part's name, a pose that is not rigid, a part that cannot be in
                metres, or one that lies in links that do not carry it.
        """
        self._require_links("part " + part.name, [link])
        if part.name in self.link_names:
            raise MachineError(f"machine {self.name}: part {part.name}: there is a link of that name")
        given = np.eye(4) if link_from_part is None else link_from_part
        pose = nearest_rigid(given, f"part {part.name}: link_from_part", MachineError)
        row = self.link_names.index(link)
        carried = Link(part.name, part.surface.vertices, part.surface.faces.astype(np.int32))
        points = carried.vertices @ pose[:3, :3].T + pose[:3, 3]
        odd = require_size(f"machine {self.name}", self.links, carried, points)
        holding = replace(
            self,
            findings=(*self.findings, *odd),
            links=(*self.links, carried),
            tree=branch.grown(self.tree, row, pose),
            parts=(*self.parts, part.name),
        )
        held, poses = branch.held_with(self.tree, row), holding.random_places(POSES)
        require_beside(f"machine {self.name}", holding.links, holding.shape, set(held.all), poses)
        hanging = [(other, len(self.links)) for other in held.hanging if self.links[other].has_geometry]
        always = always_touching(holding.shape, hanging, poses)
        touched = [self.link_names[other] for (other, _), touch in zip(hanging, always, strict=True) if touch]
        return holding.allowing(*((part.name, name) for name in touched)) if touched else holding

    def random_places(self, count: int, seed: int = 0) -> NDArray[np.float64]:
        """Where links are in poses drawn from the joints' limits, shape (count, n_links, 4, 4).

        Args:
            count: how many.
            seed: of the draw.
        """
        return self.world_from_link_array(random_poses(self._commanded, count, seed))

    def without_part(self, name: str) -> "Machine":
        """The machine without a part that it was given, and without those that hang on it.

        Raises:
            MachineError: it has no part of that name.
        """
        if name not in self.parts:
            has = ", ".join(self.parts) or "none"
            raise MachineError(f"machine {self.name}: carries no part {name!r}; parts are {has}")
        stays = branch.stays_without(self.tree, self.link_names.index(name))
        gone = {link.name for link, here in zip(self.links, stays, strict=True) if not here}
        return replace(
            self,
            links=tuple(link for link, here in zip(self.links, stays, strict=True) if here),
            tree=branch.pruned(self.tree, stays),
            allowed_contacts=tuple(pair for pair in self.allowed_contacts if not gone & set(pair)),
            own_links=None if self.own_links is None else self.own_links.without(gone),
            unchecked_links=tuple(link for link in self.unchecked_links if link not in gone),
            parts=tuple(part for part in self.parts if part not in gone),
            findings=tuple(
                told for told in self.findings if not (told.about and gone.issuperset(told.about))
            ),
        )

    def joint(self, name: str) -> Joint:
        """The commanded joint of this name.

        Raises:
            MachineError: there is none; the message lists those that exist.
        """
        for joint in self.joints:
            if joint.name == name and joint.mimic is None:
                return joint
        leader = self.leader_of(name)
        why = "" if leader is None else f" that is commanded: it follows {leader}"
        raise MachineError(
            f"machine {self.name}: no joint {name!r}{why}; joints are {', '.join(self.joint_names) or 'none'}"
        )

    def leader_of(self, name: str) -> str | None:
        """The commanded joint that a joint of this name follows (mimic); None: it follows none, or is none."""
        return next((each.leader for each in self._followers if each.joint.name == name), None)

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
        found = possible_positions(self.name, self._commanded, self.tolerance, joints)
        require_followers(self.name, self._followers, self.tolerance, joints, found)
        return found

    @cached_property
    def _commanded(self) -> tuple[Joint, ...]:
        """In the order of `joint_names`."""
        return tuple(joint for joint in self.joints if joint.mimic is None)

    @cached_property
    def _followers(self) -> tuple[Follower, ...]:
        """Each follower, and where its leader puts it."""
        return followers_of(self.joints, self.link_names, self.joint_names, self.tree)

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
