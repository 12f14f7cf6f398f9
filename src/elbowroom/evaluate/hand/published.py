"""Arms as others published them, swept by the convex hulls of what is seen of their links, as is usual."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.errors import PackageError
from elbowroom.evaluate.hand.arms import is_in_hull
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.machine import Link, Machine
from elbowroom.motion import Motion
from elbowroom.simulate import Solid
from elbowroom.simulate.shapes import box, ellipsoid, join

PACKAGE = "example-robot-data"
FOLDER = "cmeel.prefix/share/example-robot-data/robots"
PUBLISHED = {
    "UR5": "ur_description/urdf/ur5_robot.urdf",
    "Panda": "panda_description/urdf/panda.urdf",
    "Kinova": "kinova_description/robots/kinova.urdf",
    "xArm 7": "xarm_description/urdf/xarm7.urdf",
}
"""By name, files of the package."""
STANDS_AT_M = 0.7
"""Height of their bases, over the floor."""
WIDEST_RAD = 1.5
"""Joints are drawn so far from zero at most, or from their limit that is nearest to it."""
WAYS, AWAY_M, OPEN = 200, 2.0, 0.1
"""A hand can come to a place if of so many ways this share leads so far away [m] without meeting the arm."""
INTO_M = 0.025
"""A hand is in the excess of a hull that comes so near to its middle: half the radius of it, or less [m]."""
POINT_M = 1e-4
"""Edge of the box that stands for a point where distances are asked for."""


def robots_folder() -> Path:
    """Where the package's robots lie.

    Raises:
        PackageError: it is not installed.
    """
    try:
        return Path(str(metadata.distribution(PACKAGE).locate_file(FOLDER)))
    except metadata.PackageNotFoundError:
        raise PackageError(
            f"published arms are those of {PACKAGE}, which is not installed; pip install {PACKAGE}, or --own alone"
        ) from None


def turning(machine: Machine) -> list[str]:
    """Names of the joints that turn and are commanded."""
    return [name for name in machine.joint_names if machine.joint(name).kind != "prismatic"]


@dataclass(frozen=True, slots=True, eq=False)
class PublishedArm:
    """An arm whose links are swept by the convex hulls of their visual geometry.

    Args:
        name: of `PUBLISHED`.
        machine: of hulls, explained by the visual geometry or by the hulls.
        real: with its visual geometry for a body.
        surface: triangles of what moves, by link, in its frame, shape (n, 3, 3) [m].
    """

    name: str
    machine: Machine
    real: Machine
    surface: Mapping[str, NDArray[np.float64]]

    @classmethod
    def both(cls, name: str) -> dict[ExplainWith, "PublishedArm"]:
        """The arm by each way of explaining.

        Args:
            name: of `PUBLISHED`.

        Raises:
            PackageError: the package of robots is not installed.
        """
        base = np.eye(4)
        base[2, 3] = STANDS_AT_M
        path = robots_folder() / PUBLISHED[name]
        real = Machine.from_urdf(path, world_from_base=base, explain_with="visual").as_seen
        hulls = tuple(_hull(link, link) for link in real.links)
        moving = {link for joint in turning(real) for link in real.moved_links(joint)}
        surface = {
            link.name: link.triangles for link in real.links if link.name in moving and link.has_geometry
        }
        return {
            "auto": cls(name, replace(real, links=hulls), real, surface),
            "collision": cls(
                name, replace(real, links=tuple(_hull(link, None) for link in real.links)), real, surface
            ),
        }

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Joints at random, within their limits and not far from zero [m or rad]."""
        drawn = {}
        for name in self.machine.joint_names:
            joint = self.machine.joint(name)
            near = float(np.clip(0.0, joint.lower, joint.upper))
            low, high = max(joint.lower, near - WIDEST_RAD), min(joint.upper, near + WIDEST_RAD)
            drawn[name] = float(rng.uniform(low, high))
        return drawn

    def beside(
        self, joints: Mapping[str, float], away_m: tuple[float, float], rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """As of `Arm`.

        Args:
            joints: where the arm is [m or rad].
            away_m: between so far from the surface [m].
            rng: of all that is drawn.
        """
        link = list(self.surface)[rng.integers(len(self.surface))]
        triangles = self.surface[link]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        area = np.linalg.norm(normal, axis=1)
        chosen = int(rng.choice(len(triangles), p=area / area.sum()))
        shares = rng.dirichlet((1.0, 1.0, 1.0))
        outward = rng.choice((-1.0, 1.0)) * normal[chosen] / area[chosen]
        point = shares @ triangles[chosen] + rng.uniform(*away_m) * outward
        placed = self.machine.world_from_links(joints)[link]
        found: NDArray[np.float64] = placed[:3, :3] @ point + placed[:3, 3]
        return found

    def lowest_m(self, joints: Mapping[str, float]) -> float:
        """The least height of what moves [m].

        Args:
            joints: where the arm is [m or rad].
        """
        placed = self.machine.world_from_links(joints)
        return min(
            float((triangles.reshape(-1, 3) @ placed[link][2, :3]).min() + placed[link][2, 3])
            for link, triangles in self.surface.items()
        )

    def is_in_the_open(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> bool:
        """Whether a hand can come to a point: meshes are hollow, and nobody has a hand in one.

        Args:
            joints: where the arm is [m or rad].
            point_in_world: shape (3,) [m].
        """
        placed = self.real.world_from_links(joints)
        corners = np.concatenate(
            [
                link.triangles.reshape(-1, 3) @ placed[link.name][:3, :3].T + placed[link.name][:3, 3]
                for link in self.real.links
                if link.has_geometry
            ]
        )
        scene = RayScene(corners, np.arange(len(corners)).reshape(-1, 3))
        ways = np.random.default_rng(0).standard_normal((WAYS, 3))
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        far = scene.distances(np.tile(point_in_world, (WAYS, 1)), ways)
        return bool(np.mean(far > AWAY_M) >= OPEN)

    def distance(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> float:
        """Of a point from the visual geometry, by exact mesh distance; 0 where they meet [m].

        Args:
            joints: where the arm is [m or rad].
            point_in_world: shape (3,) [m].

        Raises:
            PackageError: coal is not installed.
        """
        half = np.full(3, POINT_M / 2)
        point = Solid("point", join([box(point_in_world - half, point_in_world + half)]), np.eye(4))
        return ExactTravel(self.real, [point]).gap(joints)

    def meets(
        self, joints: Mapping[str, float], motion: Motion, ball_m: NDArray[np.float64], radius_m: float
    ) -> bool:
        """As of `Arm`, by exact mesh distance.

        Args:
            joints: where the arm is [m or rad].
            motion: of one joint.
            ball_m, radius_m: its middle, shape (3,), world frame, and its radius [m].
        """
        ball = Solid("ball", join([ellipsoid(ball_m, (radius_m,) * 3, 24, 40)]), np.eye(4))
        contact = ExactTravel(self.real, [ball]).until_contact(joints, motion)
        return contact.touches and contact.travel <= motion.braking_distance

    def is_in_excess(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> bool:
        """Whether the hull of a link reaches well into a hand about a point.

        Args:
            joints: where the arm is [m or rad].
            point_in_world: shape (3,) [m].
        """
        return is_in_hull(self.machine, joints, point_in_world, INTO_M)


def _hull(link: Link, seen: Link | None) -> Link:
    """A link whose collision geometry is the hull of its visual one."""
    if not link.has_geometry:
        return link
    hull = trimesh.convex.convex_hull(link.vertices)
    return Link(link.name, np.asarray(hull.vertices), np.asarray(hull.faces, dtype=np.int32), seen)
