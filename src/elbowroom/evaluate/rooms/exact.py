"""Exact geometry as truth: how far a joint can go until a link touches a solid, by mesh distance.

Distances between meshes are coal's (https://github.com/coal-library/coal). A link and a solid cannot meet
before the link's fastest point has covered their distance, so each pair is looked at again only there
(conservative advancement), and the pair that could meet first is always looked at next.
"""

import heapq
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.extras import package
from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.simulate.solid import Mesh, Solid

NEAR_M = 1e-5
"""A distance that counts as contact [m]: travel is found too short by that, never too long."""


@dataclass(frozen=True, slots=True)
class Contact:
    """How far a motion really can go.

    Args:
        travel: until a link touches a solid, or to the reach or the joint's limit [m or rad along the joint].
        length: travel that was looked at: the reach, or less where the joint's limit comes before it.
        link: what touches; None: nothing does within `length`.
        solid: what it touches.
        speed: how fast the touching point moves per unit of travel [m per m or rad]; 0 without contact.
    """

    travel: float
    length: float
    link: str | None = None
    solid: str | None = None
    speed: float = 0.0

    @property
    def touches(self) -> bool:
        """Whether anything is touched within `length`."""
        return self.link is not None


class Nearest(NamedTuple):
    """What of a machine is nearest to anything that it must not touch.

    Args:
        distance_m: how near, 0 where they meet; at least what was enough where nothing is nearer.
        link: of the machine; None: nothing was near enough.
        solid: what it is near to: a solid, or another link.
        point_in_link: the link's nearest point, in its frame [m].
    """

    distance_m: float
    link: str | None = None
    solid: str | None = None
    point_in_link: NDArray[np.float64] | None = None


class ExactTravel:
    """Distances between a machine's checked links and solids, at one moment of a room.

    A mesh's tree of bounding volumes is built once and kept; so a room's next moment costs little.

    Args:
        machine: whose links.
        solids: what they may touch, as closed meshes; solids of the machine itself are left out.

    Raises:
        PackageError: coal is not installed.
    """

    def __init__(self, machine: Machine, solids: Sequence[Solid]) -> None:
        self._coal = package("coal")
        self._machine = machine
        self._links = {name: _Body(self._coal, mesh) for name, mesh in _meshes_of(machine).items()}
        self._solids = [_Obstacle(self._coal, solid) for solid in solids if not solid.is_machine]
        moved = {link for joint in machine.joint_names for link in machine.moved_links(joint)}
        self._bodies: dict[str, _Body] = {}
        self._moved = [name for name in self._links if name in moved]

    def gap(self, joints: Mapping[str, float], enough_m: float = np.inf) -> float:
        """The least distance of any checked link to any solid [m], 0 where they meet.

        Args:
            joints: positions by name [m or rad].
            enough_m: a greater distance is not worked out: the answer is then at least this [m].
        """
        placed = self._machine.world_from_links(joints)
        least = enough_m
        for name, body in self._links.items():
            for obstacle in self._solids:
                if obstacle.at_least(body, placed[name]) < least:
                    least = min(least, self._distance(body, placed[name], obstacle)[0])
        return least

    def nearest(
        self, joints: Mapping[str, float], pairs: Iterable[tuple[str, str]], enough_m: float = np.inf
    ) -> Nearest:
        """What is nearest at one place of the machine: a link that some joint moves and a solid, or two links.

        Args:
            joints: positions by name [m or rad].
            pairs: names of links that must not touch.
            enough_m: a greater distance is not worked out [m].
        """
        placed, found = self._machine.world_from_links(joints), Nearest(enough_m)
        both = [(name, obstacle) for name in self._moved for obstacle in self._solids]
        both += [(one, _Obstacle.of_link(self._coal, self._body(o), o, placed[o])) for one, o in pairs]
        near = sorted(
            ((obstacle.at_least(self._body(name), placed[name]), name, obstacle) for name, obstacle in both),
            key=lambda each: each[0],
        )
        for at_least, name, obstacle in near:
            if at_least >= found.distance_m:
                break
            distance, point = self._distance(self._body(name), placed[name], obstacle)
            if distance < found.distance_m:
                here = placed[name]
                found = Nearest(distance, name, obstacle.name, here[:3, :3].T @ (point - here[:3, 3]))
        return found

    @property
    def touchable(self) -> list[tuple[str, str]]:
        """Links that some joint moves, each with every solid, by their names."""
        return [(name, obstacle.name) for name in self._moved for obstacle in self._solids]

    def apart(self, joints: Mapping[str, float], link: str, other: str, enough_m: float) -> Nearest:
        """How far a link is from a solid, or from another link.

        Args:
            joints: positions by name [m or rad].
            link, other: their names.
            enough_m: where it is surely more, no more than a lower bound is worked out [m].
        """
        placed = self._machine.world_from_links(joints)
        body = self._body(link)
        if other in self._machine.link_names:
            obstacle = _Obstacle.of_link(self._coal, self._body(other), other, placed[other])
        else:
            obstacle = next(solid for solid in self._solids if solid.name == other)
        at_least = obstacle.at_least(body, placed[link])
        if at_least >= enough_m:
            return Nearest(at_least)
        distance, point = self._distance(body, placed[link], obstacle)
        here = placed[link]
        return Nearest(distance, link, other, here[:3, :3].T @ (point - here[:3, 3]))

    def gaps(self, joints: Mapping[str, float], joint: str, below_m: float) -> dict[tuple[str, str], float]:
        """Distances of links that a joint moves from solids, by link and solid, those that are small alone [m].

        Args:
            joints: positions by name [m or rad].
            joint: what moves.
            below_m: greater distances are left out [m].
        """
        placed = self._machine.world_from_links(joints)
        found = {}
        for name in self._machine.moved_links(joint):
            for obstacle in self._solids if name in self._links else ():
                if obstacle.at_least(self._links[name], placed[name]) < below_m:
                    distance = self._distance(self._links[name], placed[name], obstacle)[0]
                    if distance < below_m:
                        found[name, obstacle.name] = distance
        return found

    def until_contact(self, joints: Mapping[str, float], motion: Motion) -> Contact:
        """How far one joint can go.

        Args:
            joints: where all joints are, by name [m or rad].
            motion: joint, direction and reach.

        Raises:
            MachineError: unknown, missing or impossible joints, or a joint that others follow.
        """
        moving = self._moving(motion)
        return self._first(joints, motion, [(name, solid) for name in moving for solid in self._solids])

    def until_own_contact(
        self, joints: Mapping[str, float], motion: Motion, pairs: Iterable[tuple[str, str]]
    ) -> Contact:
        """How far one joint can go until the machine's links touch each other; its `solid` is then a link.

        Args:
            joints: where all joints are, by name [m or rad].
            motion: joint, direction and reach.
            pairs: names of links that must not touch; those that this joint does not move against each other are
                passed over.

        Raises:
            MachineError: as `until_contact`.
        """
        placed, moving = self._machine.world_from_links(joints), set(self._moving(motion))
        both = []
        for one, other in pairs:
            if (one in moving) != (other in moving):
                mover, still = (one, other) if one in moving else (other, one)
                solid = Solid(still, self._links[still].mesh, placed[still])
                both.append((mover, _Obstacle(self._coal, solid)))
        return self._first(joints, motion, both)

    def _body(self, name: str) -> "_Body":
        """A link's mesh, of one that is not checked as well: others must not touch it."""
        if name not in self._bodies:
            link = self._machine.links[self._machine.link_names.index(name)]
            self._bodies[name] = self._links.get(name) or _Body(self._coal, Mesh(link.vertices, link.faces))
        return self._bodies[name]

    def _moving(self, motion: Motion) -> list[str]:
        """Checked links that a joint moves."""
        machine, joint = self._machine, self._machine.joint(motion.joint)
        if any(other.mimic is not None and other.mimic.joint == joint.name for other in machine.joints):
            raise MachineError(
                f"exact travel: joint {joint.name} has followers, whose speeds are not known here"
            )
        return [name for name in machine.moved_links(motion.joint) if name in self._links]

    def _first(
        self, joints: Mapping[str, float], motion: Motion, pairs: Sequence[tuple[str, "_Obstacle"]]
    ) -> Contact:
        """The first contact of pairs of a link that moves and a thing that stands still."""
        machine = self._machine
        joint = machine.joint(motion.joint)
        start = float(joints[motion.joint])
        room = joint.upper - start if motion.direction > 0 else start - joint.lower
        length = float(max(0.0, min(motion.looked_at, room)))
        placed = machine.world_from_links(joints)
        axis = _Axis.of(joint.kind, joint.axis_in_joint, placed[joint.child])
        moving = {name for name, _ in pairs}
        fastest = {name: axis.greatest_speed(self._links[name], placed[name]) for name in moving}
        # pairs by the travel before which they cannot meet
        queue = [
            (obstacle.at_least(self._links[name], placed[name]) / max(fastest[name], 1e-12), n)
            for n, (name, obstacle) in enumerate(pairs)
        ]
        queue = [entry for entry in queue if entry[0] < length]
        heapq.heapify(queue)
        while queue:
            travel, n = heapq.heappop(queue)
            name, obstacle = pairs[n]
            here = {**joints, motion.joint: start + motion.direction * travel}
            world_from_link = machine.world_from_links(here)[name]
            distance, point = self._distance(self._links[name], world_from_link, obstacle)
            if distance < NEAR_M:
                return Contact(travel, length, name, obstacle.name, axis.speed(point))
            travel += distance / fastest[name]
            if travel < length:
                heapq.heappush(queue, (travel, n))
        return Contact(length, length)

    def _distance(
        self, body: "_Body", world_from_link: NDArray[np.float64], obstacle: "_Obstacle"
    ) -> tuple[float, NDArray[np.float64]]:
        """Distance of two meshes, not below 0 [m], and the link's point that is nearest."""
        coal = self._coal
        result = coal.DistanceResult()
        place = coal.Transform3s(world_from_link[:3, :3], world_from_link[:3, 3])
        distance = coal.distance(
            body.tree, place, obstacle.body.tree, obstacle.place, coal.DistanceRequest(True), result
        )
        return max(0.0, float(distance)), np.array(result.getNearestPoint1())


@kept
def _tree_of(mesh: Mesh, coal: Any) -> Any:
    """The mesh's bounding-volume tree, built once."""
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(mesh.faces), len(mesh.vertices))
    tree.addVertices(mesh.vertices)
    tree.addTriangles(mesh.faces.astype(np.int64))
    tree.endModel()
    return tree


@kept
def _meshes_of(machine: Machine) -> dict[str, Mesh]:
    return {
        link.name: Mesh(link.vertices, link.faces)
        for link in machine.links
        if link.name in machine.checked_links
    }


class _Body:
    """A mesh with its tree and a ball about it."""

    def __init__(self, coal: Any, mesh: Mesh) -> None:
        self.mesh, self.tree = mesh, _tree_of(mesh, coal)
        self.centre = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
        self.radius = float(np.linalg.norm(mesh.vertices - self.centre, axis=1).max())


class _Obstacle:
    """A solid at its place, and the world-aligned box that holds it."""

    def __init__(self, coal: Any, solid: Solid) -> None:
        self.name, self.body = solid.name, _Body(coal, solid.mesh)
        pose = solid.world_from_solid
        self.place = coal.Transform3s(pose[:3, :3], pose[:3, 3])
        vertices = solid.vertices_in_world
        self.lower, self.upper = vertices.min(axis=0), vertices.max(axis=0)

    @classmethod
    def of_link(cls, coal: Any, body: _Body, name: str, pose: NDArray[np.float64]) -> "_Obstacle":
        """A link as what others must not touch, in the box about its ball."""
        made = cls.__new__(cls)
        made.name, made.body = name, body
        made.place = coal.Transform3s(pose[:3, :3], pose[:3, 3])
        centre = pose[:3, :3] @ body.centre + pose[:3, 3]
        made.lower, made.upper = centre - body.radius, centre + body.radius
        return made

    def at_least(self, body: _Body, world_from_link: NDArray[np.float64]) -> float:
        """A lower bound of the distance: from the link's ball to the solid's box [m]."""
        centre = world_from_link[:3, :3] @ body.centre + world_from_link[:3, 3]
        outside = np.maximum(np.maximum(self.lower - centre, centre - self.upper), 0.0)
        return max(0.0, float(np.linalg.norm(outside)) - body.radius)


@dataclass(frozen=True, slots=True, eq=False)
class _Axis:
    """What one joint does to points: all move alike, or turn about a line that stands still.

    Args:
        turns: whether the joint turns.
        origin, direction: a point of the line and its unit vector, world frame.
    """

    turns: bool
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]

    @classmethod
    def of(
        cls, kind: str, axis_in_joint: NDArray[np.float64], world_from_joint: NDArray[np.float64]
    ) -> "_Axis":
        return cls(kind != "prismatic", world_from_joint[:3, 3], world_from_joint[:3, :3] @ axis_in_joint)

    def speeds(self, points_in_world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Speeds of points (n, 3) per unit of travel, shape (n,) [m per m or rad]."""
        if not self.turns:
            return np.ones(len(points_in_world))
        return np.linalg.norm(np.cross(self.direction, points_in_world - self.origin), axis=1)

    def speed(self, point_in_world: NDArray[np.float64]) -> float:
        return float(self.speeds(point_in_world[None])[0])

    def greatest_speed(self, body: _Body, world_from_link: NDArray[np.float64]) -> float:
        """Of any point of a link; turning about the axis does not change it."""
        points = body.mesh.vertices @ world_from_link[:3, :3].T + world_from_link[:3, 3]
        return float(self.speeds(points).max())
