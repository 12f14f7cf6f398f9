"""How far a joint can go until two links of a machine touch, by mesh distance (coal): the truth."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.extras import package
from elbowroom.machine import Link, Machine
from elbowroom.motion import Motion

NEAR_M = 1e-6
"""A distance that counts as contact [m]."""
FEWEST_STEPS = 2000
"""No step is shorter than this share of the way: what passes nearer than that is found only by luck."""

Pair = tuple[int, int]
"""Rows of two links."""


class _Body(NamedTuple):
    """A link's tree of bounding volumes, and a ball about it [m]."""

    tree: Any
    centre: NDArray[np.float64]
    radius: float


class ExactLinks:
    """Distances between links of a machine.

    Args:
        machine: whose links; their triangles as they were read.

    Raises:
        PackageError: coal is not installed.
    """

    def __init__(self, machine: Machine) -> None:
        self._coal = package("coal")
        self._machine = machine
        self._bodies = {row: self._body(link) for row, link in enumerate(machine.links) if link.has_geometry}

    def _body(self, link: Link) -> _Body:
        tree = self._coal.BVHModelOBBRSS()
        tree.beginModel(len(link.faces), len(link.vertices))
        tree.addVertices(link.vertices)
        tree.addTriangles(link.faces.astype(np.int64))
        tree.endModel()
        corners = link.triangles.reshape(-1, 3)
        centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
        return _Body(tree, centre, float(np.linalg.norm(corners - centre, axis=1).max()))

    def touching(self, joints: Mapping[str, float], pairs: Sequence[Pair]) -> list[Pair]:
        """Those pairs that touch.

        Args:
            joints: positions by name [m or rad].
            pairs: that are asked for.
        """
        placed = self._placed(joints)
        return [
            pair
            for pair in pairs
            if self._at_least(pair, placed) < NEAR_M and self.distance(pair, placed) < NEAR_M
        ]

    def until_contact(
        self, joints: Mapping[str, float], motion: Motion, pairs: Sequence[Pair]
    ) -> tuple[float, Pair | None]:
        """The travel up to which no pair touches, and the pair that does; None: none within the braking distance.

        Conservative advancement: a pair is looked at again after what its distance allows at its greatest speed.

        Args:
            joints: where all joints are, by name [m or rad]; no pair touches there.
            motion: joint and direction; one that no other joint follows.
            pairs: that must not touch.
        """
        start, joint = float(joints[motion.joint]), self._machine.joint(motion.joint)
        room = joint.upper - start if motion.direction > 0 else start - joint.lower
        limit, found = float(max(0.0, min(motion.braking_distance, room))), None
        moved = set(self._machine.moved_links(motion.joint))
        names = self._machine.link_names
        least_step = limit / FEWEST_STEPS
        here = self._placed(joints)
        for pair in pairs:
            if (names[pair[0]] in moved) == (names[pair[1]] in moved):
                continue
            row = pair[0] if names[pair[0]] in moved else pair[1]
            speed = max(self._speed(row, joint.child, joint.axis_in_joint, joint.unit == "m", here), 1e-9)
            travel, before = self._at_least(pair, here) / speed, 0.0
            while travel < limit:
                there = self._placed({**joints, motion.joint: start + motion.direction * travel})
                away = self.distance(pair, there)
                if away < NEAR_M:
                    limit, found = before if travel > 0 else 0.0, pair
                    break
                before = travel
                travel += max(away / speed, least_step)
        return limit, found

    def distance(self, pair: Pair, placed: NDArray[np.float64]) -> float:
        """Of two links, 0 where they meet [m].

        Args:
            pair: rows of the links.
            placed: where links are, shape (n_links, 4, 4).
        """
        coal, places = self._coal, [placed[row] for row in pair]
        one, other = (coal.Transform3s(pose[:3, :3].copy(), pose[:3, 3].copy()) for pose in places)
        trees = [self._bodies[row].tree for row in pair]
        result = coal.DistanceResult()
        return max(0.0, float(coal.distance(trees[0], one, trees[1], other, coal.DistanceRequest(), result)))

    def _placed(self, joints: Mapping[str, float]) -> NDArray[np.float64]:
        return self._machine.world_from_link_array(self._machine.positions(joints)[None])[0]

    def _at_least(self, pair: Pair, placed: NDArray[np.float64]) -> float:
        """No more than the distance of two links: that of the balls about them [m]."""
        one, other = (placed[row][:3, :3] @ self._bodies[row].centre + placed[row][:3, 3] for row in pair)
        return max(0.0, float(np.linalg.norm(one - other)) - sum(self._bodies[row].radius for row in pair))

    def _speed(
        self, row: int, child: str, axis: NDArray[np.float64], slides: bool, placed: NDArray[np.float64]
    ) -> float:
        """The greatest speed of any point of a link per unit of travel of a joint above it [m].

        Args:
            row: of the link.
            child: name of the link that the joint carries.
            axis: of the joint, in its frame.
            slides: whether the joint does.
            placed: where links are, shape (n_links, 4, 4).
        """
        if slides:
            return 1.0
        at = placed[self._machine.link_names.index(child)]
        link = self._machine.links[row]
        points = link.vertices[np.unique(link.faces)] @ placed[row][:3, :3].T + placed[row][:3, 3]
        return float(np.linalg.norm(np.cross(at[:3, :3] @ axis, points - at[:3, 3]), axis=1).max())
