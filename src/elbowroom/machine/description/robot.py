"""Links and joints as a description gives them, in the order of the file."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from elbowroom.machine.description.document import Document
from elbowroom.machine.description.numbers import number, numbers
from elbowroom.machine.description.report import Report, is_own, quoted, tag_of
from elbowroom.machine.description.shapes import (
    SIZES,
    Shape,
    children,
    origin_of,
    require_known,
    shapes_of,
    walk,
)

OF_A_LINK = ("inertial", "visual", "collision", "contact", "sensor", "verbose")
OF_A_JOINT = (
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "mimic",
    "calibration",
    "dynamics",
    "safety_controller",
)


OF_A_MIMIC = ("joint", "multiplier", "offset")
LOST_IN = {
    "link": ("origin", "pose", "mesh", *SIZES),
    "joint": ("pose", "rpy", "xyz", "lower", "upper"),
}
"""What nobody reads where it stands directly in a link or joint: it belongs into another element, or is of SDF."""
WORLD = "world"
"""The link that stands still."""


@dataclass(frozen=True, slots=True, eq=False)
class RawLink:
    """A link as its element gives it; shapes are read when they are asked for.

    Args:
        name: of the link.
        element: in the file.
        collisions, visuals: its elements of these names.
    """

    name: str
    element: etree._Element
    collisions: tuple[etree._Element, ...]
    visuals: tuple[etree._Element, ...]

    def body(self, report: Report) -> list[Shape]:
        """Its collision geometry, or else, where it has none that is more than a point, its visual geometry.

        Raises:
            MachineError: as `shapes_of`.
        """
        shapes = [shape for part in self.collisions for shape in shapes_of(part, report)]
        return shapes or self.picture(report)

    def picture(self, report: Report) -> list[Shape]:
        """Its visual geometry.

        Raises:
            MachineError: as `shapes_of`.
        """
        return [shape for part in self.visuals for shape in shapes_of(part, report)]


class RawLimit(NamedTuple):
    """Limits of a joint [m or rad]; minus or plus infinity: none."""

    lower: float
    upper: float
    element: etree._Element


class RawMimic(NamedTuple):
    """What a joint follows, and how."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class RawJoint:
    """A joint as its element gives it.

    Args:
        name, type, parent, child: as written.
        element: in the file.
        axis: as written, not of length one.
        origin: shape (4, 4).
        limit: None: it has none.
        mimic: None: it follows no other.
    """

    name: str
    type: str
    parent: str
    child: str
    element: etree._Element
    axis: NDArray[np.float64] = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    origin: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    limit: RawLimit | None = None
    mimic: RawMimic | None = None


class Robot(NamedTuple):
    """All of a description that a machine is made of."""

    name: str
    path: Path
    links: list[RawLink]
    joints: list[RawJoint]
    report: Report


def robot_of(document: Document) -> Robot:
    """Links and joints of a document.

    Raises:
        MachineError: an element without a name or another that it needs, a part that stands where nobody reads it.
    """
    root, report = document
    _nothing_is_lost(root, report)
    name = root.get("name")
    if not name:
        name = report.path.name.partition(".")[0]
        report.warn("name", root, f"<robot> has no name; it is called {name}")
    links = [_link(element, report) for element in children(root, "link")]
    if not links:
        raise report.error(root, "the robot has no <link>; a machine needs a body")
    joints = [_joint(element, report) for element in children(root, "joint")]
    links = [*_world(links, joints, report), *links]
    for what, found in (("link", links), ("joint", joints)):
        first: dict[str, etree._Element] = {}
        for one in found:
            if one.name in first:
                line = first[one.name].sourceline
                raise report.error(one.element, f"{what} {one.name!r} is there twice, also in line {line}")
            first[one.name] = one.element
    return Robot(name, report.path, links, joints, report)


def _world(links: list[RawLink], joints: list[RawJoint], report: Report) -> list[RawLink]:
    """The link `world`, where a joint hangs on it that the file does not declare: Drake's parser has it always."""
    hangs = next((joint for joint in joints if joint.parent == WORLD), None)
    if (
        hangs is None
        or any(link.name == WORLD for link in links)
        or any(joint.child == WORLD for joint in joints)
    ):
        return []
    report.warn(
        "world",
        hangs.element,
        "hangs on link 'world', which the file does not have; it is taken for what stands still",
    )
    return [RawLink(WORLD, hangs.element, (), ())]


def _nothing_is_lost(root: etree._Element, report: Report) -> None:
    """Refuses parts of a body, links and joints that stand where no reader looks for them."""
    require_known(root, ("link", "joint", "material", "transmission", "gazebo", "sensor"), report)
    for element in walk(root):
        tag, parent = tag_of(element), element.getparent()
        if tag == "geometry" and tag_of(parent) in ("link", "joint", "robot"):
            raise report.error(element, f"stands in <{tag_of(parent)}>; geometry belongs into <collision>")
        if tag in ("collision", "visual") and len(element) and tag_of(parent) != "link":
            raise report.error(element, f"stands in <{tag_of(parent)}>; it belongs into a <link>")
        if tag in ("link", "joint") and parent is not root and len(element):
            raise report.error(element, f"stands in <{tag_of(parent)}>; it belongs directly into <robot>")


def _require_read(element: etree._Element, report: Report) -> None:
    """Refuses a pose, a size or a limit that stands where nobody reads it, and would change something."""
    if tag_of(element) == "link" and not (children(element, "collision") or children(element, "visual")):
        return
    for child in element.iterchildren(etree.Element):
        tag = tag_of(child) if is_own(child) else ""
        is_nothing = tag == "origin" and np.allclose(origin_of(element, report), np.eye(4))
        if tag in LOST_IN[tag_of(element)] and not is_nothing:
            where = (
                "a body's pose and shape stand in <collision> or <visual>"
                if tag_of(element) == "link"
                else "a joint has <origin xyz= rpy=> and <limit lower= upper=>"
            )
            raise report.error(child, f"stands in <{tag_of(element)}>, where nothing reads it; {where}")


def _name(element: etree._Element, report: Report) -> str:
    name = element.get("name")
    if not name:
        raise report.error(element, f"{quoted(element)}: name is missing")
    return name


def _link(element: etree._Element, report: Report) -> RawLink:
    require_known(element, OF_A_LINK, report)
    _require_read(element, report)
    collisions, visuals = (tuple(children(element, tag)) for tag in ("collision", "visual"))
    return RawLink(_name(element, report), element, collisions, visuals)


def _joint(element: etree._Element, report: Report) -> RawJoint:
    require_known(element, OF_A_JOINT, report)
    _require_read(element, report)
    name = _name(element, report)
    kind = element.get("type")
    if not kind:
        raise report.error(element, "type is missing; allowed are fixed, revolute, continuous, prismatic")
    axis, limit, mimic = (_only(element, tag, report) for tag in ("axis", "limit", "mimic"))
    if kind == "fixed":
        axis = limit = mimic = None
    return RawJoint(
        name=name,
        type=kind,
        parent=_end(element, "parent", report),
        child=_end(element, "child", report),
        element=element,
        axis=np.array((1.0, 0.0, 0.0) if axis is None else numbers(axis, "xyz", 3, report)),
        origin=origin_of(element, report),
        limit=None if limit is None else _limit(limit, report),
        mimic=None if mimic is None else _mimic(mimic, report),
    )


def _only(element: etree._Element, tag: str, report: Report) -> etree._Element | None:
    """The child of a name; None: there is none."""
    found = children(element, tag)
    if any(dict(other.attrib) != dict(found[0].attrib) for other in found[1:]):
        raise report.error(found[1], f"a second {tag} in one <{tag_of(element)}>; which holds is not known")
    return found[0] if found else None


def _end(element: etree._Element, tag: str, report: Report) -> str:
    end = _only(element, tag, report)
    if end is None:
        raise report.error(element, f'<{tag} link="..."/> is missing')
    link = end.get("link")
    if not link:
        raise report.error(end, "link is missing; it names a link of the robot")
    return link


def _limit(element: etree._Element, report: Report) -> RawLimit:
    return RawLimit(number(element, "lower", report, 0.0), number(element, "upper", report, 0.0), element)


def _mimic(element: etree._Element, report: Report) -> RawMimic:
    for name in element.attrib:
        if "}" not in str(name) and name not in OF_A_MIMIC:
            raise report.error(
                element, f"{name} is no attribute of a mimic; allowed are {', '.join(OF_A_MIMIC)}"
            )
    joint = element.get("joint")
    if not joint:
        raise report.error(element, "joint is missing; it names the joint that leads")
    multiplier, offset = (
        number(element, *given) for given in (("multiplier", report, 1.0), ("offset", report, 0.0))
    )
    if not np.isfinite([multiplier, offset]).all():
        raise report.error(element, "multiplier and offset must be finite")
    return RawMimic(joint, multiplier, offset)
