"""Reads a URDF file: links with their triangles, joints, and the tree that they form."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import ExplainWith
from elbowroom.errors import MachineError
from elbowroom.finding import Finding
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.description.document import read_document
from elbowroom.machine.description.packages import Packages
from elbowroom.machine.description.report import Report
from elbowroom.machine.description.robot import RawJoint, Robot, robot_of
from elbowroom.machine.free_joint import PARTS, FreeJoint, Skeleton, freed
from elbowroom.machine.joint import Joint, Mimic
from elbowroom.machine.kernels.body import FIXED, SLIDES, TURNS, Tree
from elbowroom.machine.link import Link
from elbowroom.machine.link_body import Bodies, Proportions

MOVABLE = ("prismatic", "revolute", "continuous")
"""Kinds of joints that move; "fixed" is allowed beside them."""
FAR_M = 20.0
"""A joint farther from its parent's frame is said, and refused at five times that unless it carries the robot [m]."""
WIDE = {"prismatic": 100.0, "revolute": 10 * np.pi}
"""Limits wider than this are said: they may be in millimetres or degrees [m or rad]."""
NO_LIMIT = 1e4
"""A limit beyond this means that there is none [m or rad]."""


class Reading(NamedTuple):
    """How a URDF is read.

    Args:
        package_dirs: folders in which packages are looked for, before the folders above the URDF.
        without_body: names of links whose geometry is left out.
        xacro_arguments: values of the arguments of a xacro file.
        explain_with: which geometry says what cameras see of a link.
        largest_link_m: a link longer than this is refused [m]; None: as `link_body` says.
    """

    package_dirs: Sequence[Path] = ()
    without_body: Sequence[str] = ()
    xacro_arguments: Mapping[str, str] = {}
    largest_link_m: float | None = None
    explain_with: ExplainWith = "auto"


class Parts(NamedTuple):
    """What a URDF holds: links (parents first), movable joints in that order, the tree as arrays, what passes."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree
    findings: tuple[Finding, ...]


def read_urdf(path: Path, reading: Reading) -> Parts:
    """The machine that a URDF describes.

    Args:
        path: the file.
        reading: how it is read.

    Raises:
        MachineError: no such file, not XML, not a tree of links, a joint of an unknown kind or without
            limits, a mesh that is missing, or no geometry at all; names the place.
    """
    packages = Packages(path, reading.package_dirs)
    robot = robot_of(read_document(path, packages, reading.xacro_arguments))
    report = robot.report
    order = _tree_order(robot)
    into = {joint.child: joint for joint in robot.joints}
    _require_near(robot, order[0])
    joints = tuple(
        _joint(into[name], report) for name in order if name in into and into[name].type in MOVABLE
    )
    tree = _tree(order, into, joints, report)
    bodies = Bodies(robot, packages, reading.without_body, reading.largest_link_m, reading.explain_with)
    links = bodies.links(order, _proportions(order, into, joints))
    if not any(link.has_geometry for link in links):
        raise MachineError(f"{path}: no link has a mesh, box, cylinder or sphere; a machine needs a body")
    skeleton = Skeleton(links, _narrowed(joints, report, into), tree)
    free = [_free(joint, report) for joint in robot.joints if joint.type in PARTS]
    return Parts(robot.name, *freed(skeleton, free), tuple(report.findings))


def _tree_order(robot: Robot) -> list[str]:
    """Names of the links, each after its parent, in the order of the file's joints."""
    names = [link.name for link in robot.links]
    children: dict[str, list[str]] = {name: [] for name in names}
    parents: dict[str, RawJoint] = {}
    for joint in robot.joints:
        for link in (joint.parent, joint.child):
            if link not in children:
                raise robot.report.error(joint.element, f"names link {link!r}; links are {', '.join(names)}")
        if joint.child in parents:
            other = parents[joint.child].name
            raise robot.report.error(
                joint.element,
                f"link {joint.child!r} hangs on joint {other} already; links must form one tree",
            )
        parents[joint.child] = joint
        children[joint.parent].append(joint.child)
    roots = [name for name in names if name not in parents]
    if len(roots) != 1:
        raise MachineError(
            f"{robot.path}: links must form one tree; without a parent are: "
            f"{', '.join(roots) or 'none, they hang on each other in a ring'}"
        )
    order, waiting = [], roots
    while waiting:
        name = waiting.pop(0)
        order.append(name)
        waiting = children[name] + waiting
    if len(order) != len(names):
        raise MachineError(
            f"{robot.path}: links must form one tree; {sorted(set(names) - set(order))} hang in a ring"
        )
    return order


def _require_near(robot: Robot, root: str) -> None:
    """Refuses joints that are so far from their parents that the numbers must be millimetres."""
    for joint in robot.joints:
        away = float(np.linalg.norm(joint.origin[:3, 3]))
        text = f"lies {away:g} m from the frame of {joint.parent}; is its origin in millimetres?"
        if away > 5 * FAR_M and joint.parent != root:
            raise robot.report.error(joint.element, text)
        if away > FAR_M:
            robot.report.warn("unit", joint.element, text)


def _proportions(order: Sequence[str], into: Mapping[str, RawJoint], joints: Sequence[Joint]) -> Proportions:
    """How far the joints reach, and which links any of them moves."""
    offsets = sum(float(np.linalg.norm(joint.origin[:3, 3])) for joint in into.values())
    spans = [joint.upper - joint.lower for joint in joints if joint.kind == "prismatic"]
    moving: set[str] = set()
    for name in order:
        if name in into and (into[name].type != "fixed" or into[name].parent in moving):
            moving.add(name)
    return Proportions(offsets + sum(spans), frozenset(moving))


def _joint(joint: RawJoint, report: Report) -> Joint:
    axis = joint.axis
    length = float(np.linalg.norm(axis))
    if not length > 1e-6:
        raise report.error(joint.element, f"axis {axis.tolist()} must be three finite numbers, not all zero")
    lower, upper = _limits(joint, report)
    return Joint(
        name=joint.name,
        kind=joint.type,  # type: ignore[arg-type]
        parent=joint.parent,
        child=joint.child,
        axis_in_joint=axis / length,
        parent_from_joint=_origin(joint, report),
        lower=lower,
        upper=upper,
        mimic=joint.mimic and Mimic(*joint.mimic),
    )


def _limits(joint: RawJoint, report: Report) -> tuple[float, float]:
    """Where a joint ends, minus and plus infinity where it has no end."""
    if joint.type == "continuous":
        return -np.inf, np.inf
    limit = joint.limit
    if limit is None:
        turns = ', or type="continuous" if it turns without end' if joint.type == "revolute" else ""
        raise report.error(joint.element, f"a {joint.type} joint needs <limit lower= upper=>{turns}")
    lower, upper = limit.lower, limit.upper
    if lower > upper:
        raise report.error(limit.element, f"limits {lower:g} to {upper:g} must rise; are they exchanged?")
    if max(-lower, upper) > NO_LIMIT:
        report.warn(
            "limits",
            limit.element,
            f"limits {lower:g} to {upper:g} are taken for none where they are so wide",
        )
        lower = -np.inf if lower < -NO_LIMIT else lower
        upper = np.inf if upper > NO_LIMIT else upper
    elif max(-lower, upper) > WIDE[joint.type]:
        unit = "millimetres" if joint.type == "prismatic" else "degrees"
        report.warn("unit", limit.element, f"limits {lower:g} to {upper:g} are wide; are they in {unit}?")
    if lower == upper:
        report.warn("limits", limit.element, f"lower and upper are both {lower:g}: the joint cannot move")
    return lower, upper


def _narrowed(joints: tuple[Joint, ...], report: Report, into: Mapping[str, RawJoint]) -> tuple[Joint, ...]:
    """The same joints, each commanded one ending where the first of its followers ends."""
    movable = {joint.name: joint for joint in joints}
    ends = {joint.name: (joint.lower, joint.upper) for joint in joints if joint.mimic is None}
    for joint in joints:
        leader, multiplier, offset = _leader(joint, movable, into, report)
        if leader == joint.name or multiplier == 0:
            continue
        first, last = sorted(((joint.lower - offset) / multiplier, (joint.upper - offset) / multiplier))
        lower, upper = ends[leader]
        narrow = max(lower, first), min(upper, last)
        if narrow[0] < narrow[1]:
            ends[leader] = narrow
        elif lower < upper:
            report.warn(
                "limits",
                into[joint.child].element,
                f"its limits {joint.lower:g} to {joint.upper:g} leave no travel to {leader}, its leader; passed over",
            )
    return tuple(
        replace(joint, lower=ends[joint.name][0], upper=ends[joint.name][1]) if joint.mimic is None else joint
        for joint in joints
    )


def _free(joint: RawJoint, report: Report) -> FreeJoint:
    """A planar or floating joint."""
    if not np.linalg.norm(joint.axis) > 1e-6:
        raise report.error(
            joint.element, f"axis {joint.axis.tolist()} must be three finite numbers, not all zero"
        )
    return FreeJoint(joint.name, joint.type, joint.child, joint.axis)  # type: ignore[arg-type]


def _origin(joint: RawJoint, report: Report) -> NDArray[np.float64]:
    return nearest_rigid(joint.origin, f"{report.path}: joint {joint.name}: origin", MachineError)


def _tree(order: list[str], into: Mapping[str, RawJoint], joints: tuple[Joint, ...], report: Report) -> Tree:
    """The tree as kernels take it, a row for each link."""
    count = len(order)
    tree = Tree(
        parent=np.full(count, -1, dtype=np.int64),
        parent_from_joint=np.tile(np.eye(4), (count, 1, 1)),
        axis=np.zeros((count, 3)),
        kind=np.full(count, FIXED, dtype=np.int64),
        column=np.full(count, -1, dtype=np.int64),
        multiplier=np.ones(count),
        offset=np.zeros(count),
    )
    movable = {joint.name: joint for joint in joints}
    columns = {joint.name: i for i, joint in enumerate(j for j in joints if j.mimic is None)}
    for row, name in enumerate(order):
        if name not in into:
            continue
        given = into[name]
        if given.type not in (*MOVABLE, *PARTS, "fixed"):
            allowed = ", ".join((*MOVABLE, *PARTS))
            raise report.error(given.element, f"is of kind {given.type!r}; allowed are fixed, {allowed}")
        tree.parent[row] = order.index(given.parent)
        tree.parent_from_joint[row] = _origin(given, report)
        if given.name in movable:
            joint = movable[given.name]
            tree.axis[row] = joint.axis_in_joint
            tree.kind[row] = SLIDES if joint.kind == "prismatic" else TURNS
            leader, tree.multiplier[row], tree.offset[row] = _leader(joint, movable, into, report)
            tree.column[row] = columns[leader]
    return tree


def _leader(
    joint: Joint, movable: Mapping[str, Joint], into: Mapping[str, RawJoint], report: Report
) -> tuple[str, float, float]:
    """The joint that is commanded, and how this one follows it, through chains of mimics.

    Args:
        joint: that follows, or is commanded itself.
        movable: joints that move, by name.
        into: joints by the link that they carry.
        report: names the place.
    """
    multiplier, offset, seen = 1.0, 0.0, [joint.name]
    while joint.mimic is not None:
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        if joint.mimic.joint not in movable or joint.mimic.joint in seen:
            raise report.error(
                into[joint.child].element, f"mimics {joint.mimic.joint!r}, which leads nowhere"
            )
        joint = movable[joint.mimic.joint]
        seen.append(joint.name)
    return joint.name, multiplier, offset
