"""Joints of several degrees of freedom, planar and floating, made of joints of one each: a base that moves.

A joint `drive` becomes joints `drive/x`, `drive/y` and so on, one after the other, with links without a body in
between, so its pose is positions like all others: in a record of joints, asked at each frame's time, in a motion.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import invert_rigid, nearest_rigid
from elbowroom.machine.joint import Joint, JointKind
from elbowroom.machine.kernels.body import FIXED, SLIDES, TURNS, Tree
from elbowroom.machine.link import Link

FreeKind = Literal["planar", "floating"]
PARTS: Mapping[FreeKind, tuple[str, ...]] = {
    "planar": ("x", "y", "yaw"),
    "floating": ("x", "y", "z", "yaw", "pitch", "roll"),
}
"""The joints that a free one is made of, from its parent to its child."""
OUT_OF_PLANE = 1e-3
"""A pose of a planar joint may leave its plane by this much and is rounding, not a fault [m, rad]."""


class FreeJoint(NamedTuple):
    """A planar or a floating joint.

    Fields:
        name: its own, and the beginning of the names of its parts.
        kind: "planar": slides in a plane and turns about its normal; "floating": does as it likes.
        child: name of the link that it carries.
        axis_in_joint: of a planar one the plane's normal, shape (3,), in the joint's frame. x and y are the frame's
            own, turned with z onto the normal the shortest way; where that is -z, about x.
    """

    name: str
    kind: FreeKind
    child: str
    axis_in_joint: NDArray[np.float64]

    @property
    def axes_in_joint(self) -> dict[str, NDArray[np.float64]]:
        """By part, the unit vector that it slides along or turns about, shape (3,), joint frame."""
        frame = np.eye(3) if self.kind == "floating" else _plane(self.axis_in_joint)
        own = {"x": 0, "y": 1, "z": 2, "yaw": 2, "pitch": 1, "roll": 0}
        return {part: frame[:, own[part]] for part in PARTS[self.kind]}


class Skeleton(NamedTuple):
    """Links, parents first, the joints that move them, in that order, and the tree that they form."""

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree


def freed(skeleton: Skeleton, free: Sequence[FreeJoint]) -> Skeleton:
    """The same links with planar and floating joints in place of fixed ones.

    Args:
        skeleton: in which the links that they carry are fixed to their parents.
        free: the joints.

    Raises:
        MachineError: a name that a part of one would have is taken.
    """
    for joint in free:
        skeleton = _freed(skeleton, joint)
    return skeleton


def on_free_base(skeleton: Skeleton, kind: FreeKind, name: str = "base") -> Skeleton:
    """The same links on a base that moves: before the first link comes one without a body, and a joint to the first.

    Args:
        skeleton: links, joints, tree.
        kind: of the joint.
        name: of the joint.

    Raises:
        MachineError: a name that a part of it would have is taken.
    """
    links, joints, tree = skeleton
    first = Link(f"{name}/fixed", np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    grown = _tree([_FIRST, *(_row(tree, row, parent + 1) for row, parent in enumerate(tree.parent))])
    free = FreeJoint(name, kind, links[0].name, np.array([0.0, 0.0, 1.0]))
    return _freed(Skeleton((first, *links), joints, grown), free)


def free_positions(skeleton: Skeleton, name: str, parent_from_child: ArrayLike) -> dict[str, float]:
    """The positions of a free joint's parts that put the link that it carries at a pose.

    Args:
        skeleton: in which the joint is.
        name: of the planar or floating joint.
        parent_from_child: shape (4, 4), rigid.

    Raises:
        MachineError: no such joint, a pose that is not rigid, or of a planar joint one out of its plane.
    """
    from scipy.spatial.transform import Rotation  # slow to load, and few machines need it

    parts = {joint.name: joint for joint in skeleton.joints}
    kind: FreeKind = "floating" if f"{name}/roll" in parts else "planar"
    if not all(f"{name}/{part}" in parts for part in PARTS[kind]):
        raise MachineError(f"joint {name}: there is no planar or floating joint of this name")
    given = nearest_rigid(parent_from_child, f"joint {name}: pose", MachineError)
    first = parts[f"{name}/x"]
    frame = np.stack([parts[f"{name}/{axis}"].axis_in_joint for axis in "xy"], axis=1)
    frame = np.column_stack([frame, np.cross(frame[:, 0], frame[:, 1])])
    joint_from_child = invert_rigid(first.parent_from_joint) @ given
    x, y, z = frame.T @ joint_from_child[:3, 3]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # nose up or down: one of the answers will do
        yaw, pitch, roll = Rotation.from_matrix(frame.T @ joint_from_child[:3, :3] @ frame).as_euler("ZYX")
    found = dict(zip(PARTS["floating"], (x, y, z, yaw, pitch, roll), strict=True))
    if kind == "planar" and max(abs(z), abs(pitch), abs(roll)) > OUT_OF_PLANE:
        raise MachineError(
            f"joint {name}: the pose is {z:.3g} m out of the plane and tilted by {np.hypot(pitch, roll):.3g} rad; "
            "a planar joint stays in its plane, a floating one does not"
        )
    return {f"{name}/{part}": float(found[part]) for part in PARTS[kind]}


class _Row(NamedTuple):
    """One row of a tree."""

    parent: int
    parent_from_joint: NDArray[np.float64]
    axis: NDArray[np.float64]
    kind: int
    column: int
    multiplier: float
    offset: float


_FIRST = _Row(-1, np.eye(4), np.zeros(3), FIXED, -1, 1.0, 0.0)


def _row(tree: Tree, row: int, parent: int) -> _Row:
    """A row of a tree, with its parent's row as it is going to be."""
    return _Row(parent, *(column[row] for column in tree[1:]))


def _tree(rows: Sequence[_Row]) -> Tree:
    columns = zip(*rows, strict=True)
    return Tree(*(np.array(column) for column in columns))


def _freed(skeleton: Skeleton, free: FreeJoint) -> Skeleton:
    """With one free joint: rows before its child's, and joints before those of the links after it."""
    links, joints, tree = skeleton
    at = [link.name for link in links].index(free.child)
    made = _parts(free, links[tree.parent[at]].name, tree.parent_from_joint[at])
    for there in {link.name for link in links} | {joint.name for joint in joints}:
        if there in {joint.name for joint in made}:
            raise MachineError(
                f"joint {free.name}: is made of joints of which {there!r} is there already; rename it"
            )
    extra = len(made) - 1
    between = tuple(
        Link(joint.child, np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)) for joint in made[:-1]
    )
    later = {link.name for link in links[at:]}
    before = tuple(joint for joint in joints if joint.child not in later)
    column = sum(joint.mimic is None for joint in before)
    rows = [_row(tree, row, parent + extra * (parent >= at)) for row, parent in enumerate(tree.parent)]
    rows = [row._replace(column=row.column + len(made) * (row.column >= column)) for row in rows]
    rows[at : at + 1] = [
        _Row(
            int(tree.parent[at]) if n == 0 else at + n - 1,
            joint.parent_from_joint,
            joint.axis_in_joint,
            SLIDES if joint.kind == "prismatic" else TURNS,
            column + n,
            1.0,
            0.0,
        )
        for n, joint in enumerate(made)
    ]
    return Skeleton(
        (*links[:at], *between, *links[at:]), (*before, *made, *joints[len(before) :]), _tree(rows)
    )


def _parts(free: FreeJoint, parent: str, parent_from_joint: NDArray[np.float64]) -> list[Joint]:
    """The joints that a free one is made of; only the first is away from its parent."""
    made: list[Joint] = []
    for part, axis in free.axes_in_joint.items():
        kind: JointKind = "prismatic" if len(part) == 1 else "continuous"
        name = f"{free.name}/{part}"
        made.append(
            Joint(
                name=name,
                kind=kind,
                parent=made[-1].child if made else parent,
                child=name,
                axis_in_joint=axis,
                parent_from_joint=np.eye(4) if made else parent_from_joint,
                lower=-np.inf,
                upper=np.inf,
                is_posed=free.kind == "floating",
            )
        )
    made[-1] = replace(made[-1], child=free.child)
    return made


def _plane(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes x, y and normal of a plane in the joint's frame, as columns."""
    x, y, z = normal / np.linalg.norm(normal)
    if z < -1 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    a = 1 / (1 + z)
    return np.array([[1 - x * x * a, -x * y * a, x], [-x * y * a, 1 - y * y * a, y], [-x, -y, z]])
