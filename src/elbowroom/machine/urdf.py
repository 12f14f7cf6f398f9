"""Reads a URDF file: links with their triangles, joints, and the tree that they form."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree
from numpy.typing import NDArray
from yourdfpy import urdf as yourdf

from elbowroom.errors import MachineError
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.free_joint import PARTS, FreeJoint, Skeleton, freed
from elbowroom.machine.joint import Joint, Mimic
from elbowroom.machine.kernels.body import FIXED, SLIDES, TURNS, Tree
from elbowroom.machine.link import Link
from elbowroom.machine.meshes import mesh_path, triangles_of

MAX_URDF_BYTES = 16_000_000
"""A larger file is refused."""
MOVABLE = ("prismatic", "revolute", "continuous")
"""Kinds of joints that move; "fixed" is allowed beside them."""


class Parts(NamedTuple):
    """What a URDF holds: links (parents first), movable joints in that order, the tree as arrays."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tree: Tree


def read_urdf(path: Path, package_dirs: Sequence[Path]) -> Parts:
    """The machine that a URDF describes.

    Args:
        path: the file.
        package_dirs: folders in which `package://` is looked for, before the folders above the URDF.

    Raises:
        MachineError: no such file, not XML, not a tree of links, a joint of an unknown kind or without
            limits, a mesh that is missing, or no geometry at all.
    """
    robot = _parse(path)
    order = _tree_order(robot, path)
    into = {joint.child: joint for joint in robot.joints}
    by_name = {link.name: link for link in robot.links}
    links = tuple(_link(by_name[name], path, package_dirs) for name in order)
    if not any(link.has_geometry for link in links):
        raise MachineError(f"{path}: no link has a mesh, box, cylinder or sphere; a machine needs a body")
    joints = tuple(_joint(into[name], path) for name in order if name in into and into[name].type in MOVABLE)
    skeleton = Skeleton(links, joints, _tree(order, into, joints, path))
    return Parts(
        robot.name, *freed(skeleton, [_free(joint, path) for joint in robot.joints if joint.type in PARTS])
    )


def _parse(path: Path) -> yourdf.Robot:
    if not path.is_file():
        raise MachineError(f"{path}: no such file; expected a URDF")
    if path.stat().st_size > MAX_URDF_BYTES:
        raise MachineError(f"{path}: {path.stat().st_size:,} bytes, a URDF may have {MAX_URDF_BYTES:,}")
    content = path.read_bytes()
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise MachineError(f"{path}: not XML: {error}") from error
    if root.tag != "robot":
        raise MachineError(f"{path}: the outermost element is <{root.tag}>, a URDF has <robot>")
    try:
        loaded = yourdf.URDF.load(io.BytesIO(content), build_scene_graph=False, load_meshes=False)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        raise MachineError(f"{path}: not a complete URDF: {type(error).__name__}: {error}") from error
    return loaded.robot


def _tree_order(robot: yourdf.Robot, path: Path) -> list[str]:
    """Names of the links, each after its parent, in the order of the file's joints."""
    names = [link.name for link in robot.links]
    for what, values in (("link", names), ("joint", [joint.name for joint in robot.joints])):
        doubled = sorted({value for value in values if values.count(value) > 1})
        if doubled:
            raise MachineError(f"{path}: {what} {doubled[0]!r} is there twice; names must be unique")
    children: dict[str, list[str]] = {name: [] for name in names}
    for joint in robot.joints:
        for link in (joint.parent, joint.child):
            if link not in children:
                raise MachineError(
                    f"{path}: joint {joint.name} names link {link!r}; links are {', '.join(names)}"
                )
        children[joint.parent].append(joint.child)
    is_child = [child for family in children.values() for child in family]
    roots = [name for name in names if name not in is_child]
    if len(roots) != 1 or len(set(is_child)) != len(is_child):
        raise MachineError(
            f"{path}: links must form one tree; without a parent are: {', '.join(roots) or 'none'}"
        )
    order, waiting = [], roots
    while waiting:
        name = waiting.pop(0)
        order.append(name)
        waiting = children[name] + waiting
    if len(order) != len(names):
        raise MachineError(
            f"{path}: links must form one tree; {sorted(set(names) - set(order))} hang in a ring"
        )
    return order


def _link(link: yourdf.Link, path: Path, package_dirs: Sequence[Path]) -> Link:
    """Collision geometry; without any, the visual geometry as far as its files exist."""
    required = bool(link.collisions)
    vertices: list[NDArray[np.float64]] = [np.zeros((0, 3))]
    faces: list[NDArray[np.int64]] = [np.zeros((0, 3), dtype=np.int64)]
    count = 0
    for shape in link.collisions or link.visuals:
        what = f"{path}: link {link.name}"
        file = None
        if shape.geometry.mesh is not None:
            file = mesh_path(shape.geometry.mesh.filename or "", path, package_dirs)
            if file is None and required:
                raise MachineError(
                    f"{what}: mesh {shape.geometry.mesh.filename!r} is missing; looked beside and above "
                    "the URDF" + "".join(f", in {folder}" for folder in package_dirs)
                )
            if file is None:
                continue
        points, triangles = triangles_of(shape.geometry, file, what)
        if shape.origin is not None:
            link_from_shape = nearest_rigid(shape.origin, f"{what}: origin", MachineError)
            points = points @ link_from_shape[:3, :3].T + link_from_shape[:3, 3]
        vertices.append(points)
        faces.append(triangles + count)
        count += len(points)
    return Link(link.name, np.concatenate(vertices), np.concatenate(faces))


def _joint(joint: yourdf.Joint, path: Path) -> Joint:
    what = f"{path}: joint {joint.name}"
    axis = np.asarray(joint.axis, dtype=np.float64)
    length = float(np.linalg.norm(axis)) if axis.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 1e-6):
        raise MachineError(f"{what}: axis {axis.tolist()} must be three finite numbers, not all zero")
    lower, upper = -np.inf, np.inf
    if joint.type != "continuous":
        limit = joint.limit
        if limit is None or (limit.lower is None and limit.upper is None):
            raise MachineError(f"{what}: a {joint.type} joint needs <limit lower= upper=>")
        lower, upper = limit.lower or 0.0, limit.upper or 0.0
        if not (np.isfinite([lower, upper]).all() and lower <= upper):
            raise MachineError(f"{what}: limits {lower} to {upper} must be finite and rising")
    return Joint(
        name=joint.name,
        kind=joint.type,
        parent=joint.parent,
        child=joint.child,
        axis_in_joint=axis / length,
        parent_from_joint=_origin(joint, path),
        lower=lower,
        upper=upper,
        mimic=joint.mimic and Mimic(joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset),
    )


def _free(joint: yourdf.Joint, path: Path) -> FreeJoint:
    """A planar or floating joint."""
    axis = np.asarray(joint.axis, dtype=np.float64)
    if not (axis.shape == (3,) and np.isfinite(axis).all() and np.linalg.norm(axis) > 1e-6):
        raise MachineError(
            f"{path}: joint {joint.name}: axis {axis.tolist()} must be three finite numbers, not all zero"
        )
    return FreeJoint(joint.name, joint.type, joint.child, axis)


def _origin(joint: yourdf.Joint, path: Path) -> NDArray[np.float64]:
    given = np.eye(4) if joint.origin is None else joint.origin
    return nearest_rigid(given, f"{path}: joint {joint.name}: origin", MachineError)


def _tree(order: list[str], into: dict[str, yourdf.Joint], joints: tuple[Joint, ...], path: Path) -> Tree:
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
            raise MachineError(
                f"{path}: joint {given.name} is of kind {given.type!r}; "
                f"allowed are fixed, {', '.join((*MOVABLE, *PARTS))}"
            )
        tree.parent[row] = order.index(given.parent)
        tree.parent_from_joint[row] = _origin(given, path)
        if given.name in movable:
            joint = movable[given.name]
            tree.axis[row] = joint.axis_in_joint
            tree.kind[row] = SLIDES if joint.kind == "prismatic" else TURNS
            leader, tree.multiplier[row], tree.offset[row] = _leader(joint, movable, path)
            tree.column[row] = columns[leader]
    return tree


def _leader(joint: Joint, movable: dict[str, Joint], path: Path) -> tuple[str, float, float]:
    """The joint that is commanded, and how this one follows it, through chains of mimics."""
    multiplier, offset, seen = 1.0, 0.0, [joint.name]
    while joint.mimic is not None:
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        if joint.mimic.joint not in movable or joint.mimic.joint in seen:
            raise MachineError(
                f"{path}: joint {joint.name} mimics {joint.mimic.joint!r}, which leads nowhere"
            )
        joint = movable[joint.mimic.joint]
        seen.append(joint.name)
    return joint.name, multiplier, offset
