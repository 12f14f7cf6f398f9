"""Four arms of boxes with openings between them, and collision geometry that fills the openings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import trimesh
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.machine import Machine
from elbowroom.motion import Motion

Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Edges and middle [m], the frame of its link."""

POST: tuple[Box, ...] = (((0.16, 0.16, 0.8), (0, 0, 0.4)),)
BAR: tuple[Box, ...] = (((0.5, 0.08, 0.08), (0.25, 0, 0)),)
RAILS: tuple[Box, ...] = (
    ((0.1, 0.24, 0.06), (0.0, 0, 0)),
    ((0.5, 0.04, 0.06), (0.25, 0.1, 0)),
    ((0.5, 0.04, 0.06), (0.25, -0.1, 0)),
    ((0.08, 0.24, 0.06), (0.5, 0, 0)),
)
FORK: tuple[Box, ...] = (
    ((0.2, 0.06, 0.06), (0.1, 0, 0)),
    ((0.05, 0.26, 0.06), (0.22, 0, 0)),
    ((0.25, 0.04, 0.05), (0.36, 0.11, 0)),
    ((0.25, 0.04, 0.05), (0.36, -0.11, 0)),
)
C: tuple[Box, ...] = (
    ((0.06, 0.06, 0.5), (0.1, 0, 0)),
    ((0.4, 0.06, 0.06), (0.28, 0, 0.22)),
    ((0.4, 0.06, 0.06), (0.28, 0, -0.22)),
)
BENT: tuple[Box, ...] = (((0.4, 0.07, 0.07), (0.2, 0, 0)), ((0.07, 0.07, 0.4), (0.4, 0, 0.2)))
RING: tuple[Box, ...] = (
    ((0.14, 0.06, 0.06), (0.06, 0, 0)),
    ((0.05, 0.4, 0.05), (0.15, 0, 0)),
    ((0.05, 0.4, 0.05), (0.5, 0, 0)),
    ((0.4, 0.05, 0.05), (0.325, 0.175, 0)),
    ((0.4, 0.05, 0.05), (0.325, -0.175, 0)),
)
ARMS: dict[str, tuple[tuple[Box, ...], tuple[Box, ...], tuple[float, float, float], str]] = {
    "rails and fork": (RAILS, FORK, (0.5, 0, 0), "box"),
    "bar and C": (BAR, C, (0.5, 0, 0), "box"),
    "bent": (BENT, BENT, (0.4, 0, 0.4), "hull"),
    "bar and ring": (BAR, RING, (0.5, 0, 0), "hull"),
}
"""By name: the boxes of the upper and of the lower arm, where the elbow is on the upper one [m], and what is laid
around each: the box or the convex hull."""


STEPS = 60
"""At so many places along S it is looked whether the arm meets the hand."""


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """An arm on a post: it turns, lifts, and bends its elbow.

    Args:
        name: of `ARMS`.
        machine: swept by what is laid around it, and explained by what `explain_with` says.
        real: the boxes of its links, by the link's name.
    """

    name: str
    machine: Machine
    real: Mapping[str, tuple[Box, ...]]

    @classmethod
    def in_folder(cls, name: str, folder: Path, explain_with: ExplainWith) -> "Arm":
        """Writes its URDF and meshes, and reads them.

        Args:
            name: of `ARMS`.
            folder: where to.
            explain_with: which geometry explains images.
        """
        upper, lower, elbow, around = ARMS[name]
        real = {"post": POST, "upper": upper, "lower": lower}
        links = "".join(
            _link(link, boxes, _laid_around(link, boxes, "box" if link == "post" else around, folder))
            for link, boxes in real.items()
        )
        # between post and upper arm a link without a body, as where two axes meet
        joints = "".join(
            (
                _joint("turn", "post", "shoulder", (0, 0, 0.9), "0 0 1"),
                _joint("lift", "shoulder", "upper", (0, 0, 0), "0 1 0"),
                _joint("bend", "upper", "lower", elbow, "0 1 0"),
            )
        )
        path = folder / "arm.urdf"
        path.write_text(f'<robot name="arm">{links}<link name="shoulder"/>{joints}</robot>')
        return cls(name, Machine.from_urdf(path, explain_with=explain_with), real)

    @classmethod
    def both(cls, name: str) -> dict[ExplainWith, "Arm"]:
        """The arm by each way of explaining.

        Args:
            name: of `ARMS`.
        """
        with TemporaryDirectory() as folder:
            ways: tuple[ExplainWith, ExplainWith] = ("auto", "collision")
            return {words: cls.in_folder(name, Path(folder), words) for words in ways}

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Joints at random [rad]."""
        return {"turn": rng.uniform(-2, 2), "lift": rng.uniform(-0.9, 0.5), "bend": rng.uniform(-1.2, 1.2)}

    def beside(
        self, joints: Mapping[str, float], away_m: tuple[float, float], rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """A point at random that lies before one of the arm's faces, shape (3,), world frame [m].

        Args:
            joints: where the arm is [rad].
            away_m: between so far from the face [m].
            rng: of all that is drawn.
        """
        placed = self.machine.world_from_links(joints)
        link = ("upper", "lower")[rng.integers(2)]
        edges, middle = self.real[link][rng.integers(len(self.real[link]))]
        at, axis, way = rng.uniform(-0.5, 0.5, 3), rng.integers(3), rng.choice((-1.0, 1.0))
        at[axis] = 0.5 * way
        point = at * edges + middle
        point[axis] += way * rng.uniform(*away_m)
        found: NDArray[np.float64] = placed[link][:3, :3] @ point + placed[link][:3, 3]
        return found

    def lowest_m(self, joints: Mapping[str, float]) -> float:
        """The least height of what moves, or less [m].

        Args:
            joints: where the arm is [rad].
        """
        placed = self.machine.world_from_links(joints)
        return min(_corners_z(placed[link], self.real[link]) for link in ("upper", "lower"))

    def is_in_the_open(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> bool:
        """Whether a hand can come to a point: boxes are solid, and enclose nothing.

        Args:
            joints: where the arm is [rad].
            point_in_world: shape (3,) [m].
        """
        return True

    def distance(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> float:
        """Of a point from the boxes, by closed form; 0 within one [m].

        Args:
            joints: where the arm is [rad].
            point_in_world: shape (3,) [m].
        """
        placed = self.machine.world_from_links(joints)
        return min(
            float(
                np.linalg.norm(
                    np.maximum(
                        np.abs(_in_link(placed[link], point_in_world) - middle) - np.divide(edges, 2), 0
                    )
                )
            )
            for link, boxes in self.real.items()
            for edges, middle in boxes
        )

    def meets(
        self, joints: Mapping[str, float], motion: Motion, ball_m: NDArray[np.float64], radius_m: float
    ) -> bool:
        """Whether the arm itself meets a ball within the braking distance of a motion.

        Args:
            joints: where the arm is [rad].
            motion: of one joint.
            ball_m, radius_m: its middle, shape (3,), world frame, and its radius [m].
        """
        for travel in np.linspace(0.0, motion.braking_distance, STEPS):
            there = {**joints, motion.joint: joints[motion.joint] + motion.direction * travel}
            if self.distance(there, ball_m) < radius_m:
                return True
        return False

    def is_in_excess(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> bool:
        """Whether a point lies in what is laid around a link.

        Args:
            joints: where the arm is [rad].
            point_in_world: shape (3,) [m].
        """
        return is_in_hull(self.machine, joints, point_in_world)


def is_in_hull(
    machine: Machine,
    joints: Mapping[str, float],
    point_in_world: NDArray[np.float64],
    within_m: float = 0.0,
) -> bool:
    """Whether a point lies in a link's collision geometry, which is convex, or no farther from its planes.

    Args:
        machine: of convex links.
        joints: where it is [m or rad].
        point_in_world: shape (3,) [m].
        within_m: so far outside of a plane it may lie [m].
    """
    placed = machine.world_from_links(joints)
    for link in machine.links:
        if link.has_geometry:
            planes = trimesh.Trimesh(link.vertices, link.faces)
            beyond = (
                _in_link(placed[link.name], point_in_world) - planes.triangles[:, 0]
            ) * planes.face_normals
            if (beyond.sum(axis=1) <= within_m).all():
                return True
    return False


def _corners_z(world_from_link: NDArray[np.float64], boxes: Sequence[Box]) -> float:
    """The least height of a link's boxes, or less [m]."""
    return min(
        float((world_from_link[:3, :3] @ middle + world_from_link[:3, 3])[2] - np.linalg.norm(edges) / 2)
        for edges, middle in boxes
    )


def _in_link(
    world_from_link: NDArray[np.float64], point_in_world: NDArray[np.float64]
) -> NDArray[np.float64]:
    moved: NDArray[np.float64] = world_from_link[:3, :3].T @ (point_in_world - world_from_link[:3, 3])
    return moved


def _laid_around(link: str, boxes: Sequence[Box], around: str, folder: Path) -> str:
    """What collides: the box about some boxes, or their convex hull in a file."""
    corners = _corners(boxes)
    if around == "hull":
        trimesh.convex.convex_hull(corners).export(folder / f"{link}.stl")
        return f'<geometry><mesh filename="{link}.stl"/></geometry>'
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    return _shape((tuple(upper - lower), tuple((lower + upper) / 2)))


def _corners(boxes: Sequence[Box]) -> NDArray[np.float64]:
    signs = np.array(list(np.ndindex(2, 2, 2))) - 0.5
    return np.concatenate([signs * edges + middle for edges, middle in boxes])


def _shape(box: Box) -> str:
    edges, middle = (" ".join(f"{value:.6g}" for value in values) for values in box)
    return f'<origin xyz="{middle}"/><geometry><box size="{edges}"/></geometry>'


def _link(name: str, boxes: Sequence[Box], around: str) -> str:
    seen = "".join(f"<visual>{_shape(box)}</visual>" for box in boxes)
    return f'<link name="{name}">{seen}<collision>{around}</collision></link>'


def _joint(name: str, parent: str, child: str, at: tuple[float, float, float], axis: str) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at[0]} {at[1]} {at[2]}"/><axis xyz="{axis}"/>'
        '<limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>'
    )
