"""Pieces of geometry as a link's elements give them: kind, sizes, mesh file, pose in the link."""

import difflib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from elbowroom.geometry.transforms import turn_of_rpy
from elbowroom.machine.description.numbers import WORDS, numbers
from elbowroom.machine.description.report import Report, is_own, tag_of

Kind = Literal["mesh", "box", "cylinder", "sphere", "capsule", "ellipsoid"]
SIZES: dict[str, tuple[str, ...]] = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "capsule": ("radius", "length"),
    "ellipsoid": ("a", "b", "c"),
}
"""The attributes that give a solid's sizes [m]. A capsule's length is that of its cylinder, without the caps."""
UNEVEN = 50.0
"""A mesh is stretched by less along one axis than along another; more is said."""
ALLOWED = "mesh, box, cylinder, sphere, capsule"


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """One piece of geometry.

    Args:
        kind: of solid, or a mesh.
        element: in the file, for messages.
        link_from_shape: shape (4, 4), as the origin says.
        sizes: of a solid [m], in the order of `SIZES`; of a box its three edges.
        filename: of a mesh, as written.
        scale: of a mesh, along each axis.
    """

    kind: Kind
    element: etree._Element
    link_from_shape: NDArray[np.float64]
    sizes: tuple[float, ...] = ()
    filename: str = ""
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)


def shapes_of(part: etree._Element, report: Report) -> list[Shape]:
    """What a `<collision>` or `<visual>` holds; a point that marks a frame is no shape, and is said.

    Raises:
        MachineError: no geometry, one of an unknown kind, numbers that are missing or not usable.
    """
    require_known(part, ("origin", "geometry"), report)
    geometries = children(part, "geometry")
    if not geometries:
        raise report.error(part, "holds no <geometry>")
    link_from_shape = origin_of(part, report)
    found = [at for geometry in geometries for at in _solids(geometry, report)]
    if len(found) > 1:
        report.warn(
            "shapes", geometries[0], f"{len(found)} shapes in one <{tag_of(part)}>; all of them are taken"
        )
    shapes = [_shape(at, link_from_shape, report) for at in found]
    return [shape for shape in shapes if shape is not None]


def _solids(geometry: etree._Element, report: Report) -> list[etree._Element]:
    found = list(geometry.iterchildren(etree.Element))
    if not found:
        raise report.error(geometry, f"is empty; expected one of {ALLOWED}")
    for element in found:
        if tag_of(element) not in (*SIZES, "mesh"):
            raise report.error(element, f"is of no kind that is read; allowed are {ALLOWED}")
    return found


def _shape(element: etree._Element, link_from_shape: NDArray[np.float64], report: Report) -> Shape | None:
    kind: Kind = tag_of(element)  # type: ignore[assignment]
    if kind == "mesh":
        _require_mesh_words(element, report)
        filename = element.get("filename") or element.get("uri") or ""
        if not filename.strip():
            raise report.error(element, "has no filename")
        return Shape(kind, element, link_from_shape, filename=filename, scale=_scale(element, report))
    if kind == "box":
        sizes = numbers(element, "size", 3, report)
    else:
        sizes = tuple(value for name in SIZES[kind] for value in numbers(element, name, 1, report))
    if min(sizes) < 0:
        raise report.error(element, f"a size is negative; sizes {_said(sizes)} must be above 0 [m]")
    if max(sizes) == 0:
        report.warn(
            "shapes", element, "is a point without size, as it marks a frame; it is no part of the body"
        )
        return None
    if min(sizes) == 0 and not (kind == "capsule" and sizes[0] > 0):
        raise report.error(element, f"a size is 0; sizes {_said(sizes)} must be above 0 [m]")
    return Shape(kind, element, link_from_shape, sizes=sizes)


def _require_mesh_words(element: etree._Element, report: Report) -> None:
    """Refuses attributes that would say a mesh's size and are no scale."""
    for name in element.attrib:
        if name in ("scale", "filename", "uri") or "}" in str(name):
            continue
        if name in ("unit", "units", "size") or difflib.get_close_matches(
            str(name).lower(), ("scale",), cutoff=0.6
        ):
            raise report.error(
                element,
                f'{name} is no attribute of a mesh; its size is set by scale="0.001 0.001 0.001" and the like',
            )


def _said(sizes: tuple[float, ...]) -> str:
    return " ".join(f"{size:g}" for size in sizes)


def _scale(element: etree._Element, report: Report) -> tuple[float, ...]:
    text = element.get("scale")
    if text is None:
        return (1.0, 1.0, 1.0)
    count = len(text.split())
    if count not in (1, 3):
        raise report.error(element, f"scale holds {count} numbers; expected {WORDS[3]}, or one for all axes")
    scale = numbers(element, "scale", count, report)
    if 0.0 in scale:
        raise report.error(element, "a scale of 0 leaves nothing of the mesh")
    least, most = min(map(abs, scale)), max(map(abs, scale))
    if most >= UNEVEN * least:
        report.warn(
            "unit",
            element,
            f"scale differs by a factor of {most / least:.4g} between the axes; is that meant?",
        )
    return scale if count == 3 else scale * 3


def origin_of(part: etree._Element, report: Report) -> NDArray[np.float64]:
    """Pose of a shape in its link, or of a joint in its parent, shape (4, 4).

    Raises:
        MachineError: two origins, numbers that are missing or no numbers, an attribute of another name.
    """
    origins = children(part, "origin")
    if len(origins) > 1:
        raise report.error(origins[1], f"a second origin in one <{tag_of(part)}>; which holds is not known")
    if not origins:
        return np.eye(4)
    origin = origins[0]
    for name in origin.attrib:
        if "}" not in str(name) and name not in ("xyz", "rpy", "quat_xyzw"):
            raise report.error(
                origin, f"{name} is no attribute of an origin; allowed are xyz, rpy, quat_xyzw"
            )
    xyz = numbers(origin, "xyz", 3, report) if origin.get("xyz") is not None else (0.0, 0.0, 0.0)
    if origin.get("quat_xyzw") is not None:
        return _from_quaternion(origin, xyz, report)
    rpy = numbers(origin, "rpy", 3, report) if origin.get("rpy") is not None else (0.0, 0.0, 0.0)
    if max(map(abs, rpy)) > 4 * math.pi:
        report.warn("unit", origin, "rpy is in radians, and turns more than twice round; are these degrees?")
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn_of_rpy(*rpy), xyz
    return pose


def _from_quaternion(origin: etree._Element, xyz: tuple[float, ...], report: Report) -> NDArray[np.float64]:
    x, y, z, w = numbers(origin, "quat_xyzw", 4, report)
    if origin.get("rpy") is not None:
        raise report.error(origin, "both rpy and quat_xyzw; which holds is not known")
    if math.hypot(x, y, z, w) < 1e-6:
        raise report.error(origin, "quat_xyzw is no rotation: all four numbers are 0")
    from trimesh import transformations  # slow to load, and hardly any description has one

    pose: NDArray[np.float64] = transformations.quaternion_matrix((w, x, y, z))
    pose[:3, 3] = xyz
    return pose


def children(element: etree._Element, tag: str) -> list[etree._Element]:
    """Children of a name, whatever their namespace."""
    return [child for child in element.iterchildren(etree.Element) if tag_of(child) == tag]


def require_known(element: etree._Element, words: tuple[str, ...], report: Report) -> None:
    """Refuses a child whose name is nearly, but not quite, one of some words: what it says would be lost.

    Args:
        element: whose children are looked at.
        words: names that they may have; names far from all of them belong to other programs, and pass.
        report: names the place.

    Raises:
        MachineError: a name that is misspelt.
    """
    for child in element.iterchildren(etree.Element):
        tag = tag_of(child)
        if tag in words or not is_own(child):
            continue
        near = difflib.get_close_matches(tag.lower(), words, n=1, cutoff=0.8)
        if near:
            raise report.error(child, f"is nothing that a <{tag_of(element)}> holds; is {near[0]} meant?")


def walk(root: etree._Element) -> Iterator[etree._Element]:
    """All elements of a file but what simulators' own elements hold."""
    for child in root.iterchildren(etree.Element):
        if tag_of(child) not in ("gazebo", "transmission", "ros2_control", "mujoco", "drake"):
            yield child
            yield from walk(child)
