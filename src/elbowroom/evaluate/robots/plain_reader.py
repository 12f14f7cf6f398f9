"""A second reader of URDFs, plain and with no code of the first: which links have geometry, what is missing."""

import re
import xml.etree.ElementTree as tree
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

_PREFIX = re.compile(rb"(</?|\s)(\w+):(?=[\w-]+[\s/>=])")
_ASKED = re.compile(rb"\$\(arg\s+(\w+)\)")
_GIVEN = re.compile(rb"<xacro:arg\s+name=\"(\w+)\"\s+default=")
_DECLARATION = re.compile(rb"^\s*(<!--.*?-->\s*)*<\?xml[^>]*\?>", re.DOTALL)


class Plain(NamedTuple):
    """What stands in a file.

    Args:
        with_geometry: names of links that have collision geometry, or else visual geometry, of more than no size.
        lacks: why no reader can make a whole machine of it; "": it can.
        moves: whether any joint moves: else it is a thing and no machine.
    """

    with_geometry: frozenset[str]
    lacks: str
    moves: bool


def plain(path: Path, root: Path) -> Plain:
    """Reads a file.

    Args:
        path: the URDF.
        root: the folder of its package: a mesh of which no file has the name there is missing.
    """
    content = path.read_bytes()
    robot = _robot(content)
    if robot is None:
        return Plain(frozenset(), "is not XML", False)
    links = robot.findall("link")
    bodies = {link.get("name", ""): _pieces(link) for link in links}
    with_geometry = frozenset(name for name, pieces in bodies.items() if any(map(_has_size, pieces)))
    lacks = _lacks(robot, bodies, with_geometry) or _missing_mesh(bodies, path, root)
    if set(_ASKED.findall(content)) - set(_GIVEN.findall(content)):
        lacks = "takes arguments of xacro that it does not set"
    moves = any(joint.get("type") not in (None, "fixed") for joint in robot.findall("joint"))
    return Plain(with_geometry, lacks, moves)


def _robot(content: bytes) -> tree.Element | None:
    content = _DECLARATION.sub(b"", content.removeprefix(b"\xef\xbb\xbf").lstrip())
    for text in (content, _PREFIX.sub(rb"\1\2_", content)):
        try:
            return tree.fromstring(text)
        except (tree.ParseError, ValueError):
            continue
    return None


def _pieces(link: tree.Element) -> list[tree.Element]:
    for tag in ("collision", "visual"):
        found = [
            piece for at in link.findall(tag) for geometry in at.findall("geometry") for piece in geometry
        ]
        if any(map(_has_size, found)):
            return found
    return []


def _has_size(piece: tree.Element) -> bool:
    words = " ".join(
        value for name, value in piece.attrib.items() if name in ("size", "radius", "length")
    ).split()
    return piece.tag == "mesh" or any(word not in ("0", "0.0", "0.") for word in words)


def _lacks(robot: tree.Element, bodies: dict[str, list[tree.Element]], with_geometry: frozenset[str]) -> str:
    if robot.tag != "robot" or not bodies:
        return "has no link"
    joints = robot.findall("joint")
    ends = {end.get("link") for joint in joints for tag in ("parent", "child") for end in joint.findall(tag)}
    if not ends <= {*bodies, "world"}:
        return "names links that stand in another file"
    if not with_geometry:
        return "has no geometry"
    return ""


def _missing_mesh(bodies: dict[str, list[tree.Element]], path: Path, root: Path) -> str:
    """That a mesh is nowhere: neither beside or above the file, nor, of a package, under its last two names."""
    for piece in (piece for pieces in bodies.values() for piece in pieces if piece.tag == "mesh"):
        name = (piece.get("filename") or "").replace("\\", "/")
        scheme, _, rest = name.rpartition("://")
        if scheme:
            is_there = "/".join(rest.lower().strip("/").split("/")[-2:]) in _files_of(root)
        else:
            is_there = any((folder / name).is_file() for folder in list(path.parents)[:3])
        if not is_there:
            return f"names a mesh that its package lacks, {name}"
    return ""


@lru_cache(maxsize=2)
def _files_of(root: Path) -> frozenset[str]:
    """The last name, and the last two, of all files of a package, in small letters."""
    return frozenset("/".join(at.parts[-names:]).lower() for at in root.rglob("*") for names in (1, 2))
