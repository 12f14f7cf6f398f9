"""Four arms of boxes with openings between them, and collision geometry that fills the openings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.machine import Machine

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

    def is_in_excess(self, joints: Mapping[str, float], point_in_world: NDArray[np.float64]) -> bool:
        """Whether a point lies in what is laid around a link.

        Args:
            joints: where the arm is [rad].
            point_in_world: shape (3,) [m].
        """
        placed = self.machine.world_from_links(joints)
        for link in self.machine.links:
            if link.has_geometry:
                planes = trimesh.Trimesh(link.vertices, link.faces)
                beyond = (
                    _in_link(placed[link.name], point_in_world) - planes.triangles[:, 0]
                ) * planes.face_normals
                if (beyond.sum(axis=1) <= 0).all():
                    return True
        return False


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
