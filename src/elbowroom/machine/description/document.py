"""A description's file as a tree of elements: small slips of XML pass and are said, xacro is expanded or named."""

import re
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from elbowroom.errors import MachineError
from elbowroom.files.content import HEAD, what_it_is
from elbowroom.machine.description import xacro
from elbowroom.machine.description.packages import Packages
from elbowroom.machine.description.report import Report, first_entity, tag_of
from elbowroom.machine.description.shapes import SIZES, walk

MAX_URDF_BYTES = 16_000_000
"""A larger file is refused."""
OTHER_LANGUAGES = {
    "sdf": "this is SDF, Gazebo's format; give the URDF that it was made of",
    "mujoco": "this is MJCF, MuJoCo's format; give the URDF that it was made of",
    "COLLADA": "this is a mesh; give the URDF that names it",
    "package": "this is a package's manifest; give a URDF of that package",
}
"""What the outermost element says of a file that is no URDF."""
WORDS_OF_A_URDF = {
    *("link", "joint", "material", "color", "texture", "inertial", "mass", "inertia", "visual", "collision"),
    *("origin", "geometry", "mesh", *SIZES, "parent", "child", "axis", "limit", "mimic", "dynamics"),
    *("calibration", "safety_controller", "sensor", "contact", "verbose"),
}
"""Elements that a URDF may hold itself, whatever macros are called."""
_HARMLESS = {
    etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE: "a prefix is not declared",
    etree.ErrorTypes.ERR_HYPHEN_IN_COMMENT: "a comment holds two hyphens",
}
_INCLUDES = "{http://www.w3.org/2001/XInclude}"
_DECLARATION = re.compile(rb"<\?xml\b[^>]*\?>")
_VERSION = re.compile(rb"(<\?xml\s+version\s*=\s*[\"'])(?!1\.)([^\"']*)")
_BEFORE_DECLARATION = re.compile(rb"(\s|<!--.*?-->)*(?=<\?xml\b)", re.DOTALL)


class Document(NamedTuple):
    """The outermost element, and the report that names places in it."""

    root: etree._Element
    report: Report


def read_document(path: Path, packages: Packages, xacro_arguments: Mapping[str, str]) -> Document:
    """The tree of elements of a URDF, or of a xacro file that is expanded for it.

    Args:
        path: the file.
        packages: where `$(find ...)` of a xacro file looks.
        xacro_arguments: values of its arguments.

    Raises:
        MachineError: no such file, not XML, not a URDF, or xacro that cannot be expanded.
    """
    if not path.is_file():
        what = "a folder" if path.is_dir() else "no such file"
        raise MachineError(f"{path}: {what}; expected a URDF")
    size = path.stat().st_size
    if size > MAX_URDF_BYTES:
        raise MachineError(f"{path}: {size:,} bytes, a URDF may have {MAX_URDF_BYTES:,}")
    report = Report(path)
    root = _parsed(path.read_bytes(), report)
    for element in root.iter(f"{_INCLUDES}*"):
        raise report.error(
            element, "stands for another file (XInclude), which is not read: put its content there"
        )
    sign, entity = xacro.first_sign(root), first_entity(root)
    if entity is not None and (sign is None or not _stands_in_the_file(entity)):
        raise report.error(
            entity.getparent(),
            f"{entity.text} stands for other text (an XML entity), which is not read: put its content there",
        )
    if sign is not None:
        made = xacro.expanded(path, report.said(sign.element, sign.text), packages, xacro_arguments)
        report.expanded, report.lines_before = True, 0
        root = _parsed(made.content, report)
        left = xacro.first_sign(root)
        if left is not None:
            raise report.error(left.element, f"{left.text}, also after xacro expanded the file")
        _require_calls(made.macros, root, report)
    elif xacro_arguments:
        raise MachineError(f"{path}: arguments of xacro are given, and nothing in the file is xacro")
    if tag_of(root) != "robot":
        hint = OTHER_LANGUAGES.get(tag_of(root))
        raise MachineError(
            f"{path}: the outermost element is <{tag_of(root)}>, a URDF has <robot>"
            + (f"; {hint}" if hint else "")
        )
    return Document(root, report)


def _stands_in_the_file(entity: etree._Entity) -> bool:
    """Whether the file says itself what an entity stands for; xacro puts that in its place."""
    said = entity.getroottree().docinfo.internalDTD
    return said is not None and any(
        one.name == entity.name and one.content is not None and one.system_url is None
        for one in said.iterentities()
    )


def _require_calls(macros: Collection[str], root: etree._Element, report: Report) -> None:
    """Refuses a file that defines macros and calls none, or calls one as xacro did before it had a prefix.

    Args:
        macros: names of those that are defined.
        root: the outermost element, expanded.
        report: names the file.
    """
    if macros and not any(tag_of(child) == "link" for child in root.iterchildren(etree.Element)):
        raise MachineError(
            f"{report.path}: only defines macros ({', '.join(sorted(macros))}) and calls none: the robot has no "
            "<link>. Give the file that includes this one and calls them"
        )
    called_from = (root, *(child for child in walk(root) if tag_of(child) in ("link", "joint")))
    for element in (child for parent in called_from for child in parent.iterchildren(etree.Element)):
        name = tag_of(element)
        if name in macros and name not in WORDS_OF_A_URDF:
            raise report.error(
                element,
                f"bears the name of a macro and does not call it; write <xacro:{name}> where it stands",
            )


def _parsed(content: bytes, report: Report) -> etree._Element:
    """The outermost element; what other readers pass over passes with a warning."""
    if not content.strip():
        raise MachineError(f"{report.path}: is empty; expected a URDF")
    found = what_it_is(content[:HEAD])
    if found:
        raise MachineError(f"{report.path}: is {found}; expected a URDF")
    content = _without_what_stands_first(content, report)
    version = _VERSION.match(content)
    if version is not None:
        report.warn(
            "xml", None, f"line 1: there is no XML of version {version[2].decode('latin-1')!r}; read as 1.0"
        )
        content = _VERSION.sub(rb"\g<1>1.0", content, count=1)
    try:
        return _tree(content, recover=False)
    except etree.XMLSyntaxError as strict:
        try:
            content.decode("utf-8")
        except UnicodeDecodeError:
            content = _as_utf8(content, report)
        root = _tree(content, recover=True)
        faults = [] if root is None else [e for e in strict_errors(content) if e.type not in _HARMLESS]
        if root is None or faults:
            line = (faults[0].line if faults else strict.lineno or 1) + report.lines_before
            text = faults[0].message if faults else strict.msg
            raise MachineError(f"{report.path}: line {line}: not XML: {text}") from None
        for entry in strict_errors(content):
            line = entry.line + report.lines_before
            report.warn("xml", None, f"line {line}: {_HARMLESS[entry.type]} ({entry.message}); passed over")
        return root


def strict_errors(content: bytes) -> list[etree._LogEntry]:
    """All that a strict parser finds wrong, also where it could go on."""
    parser = _parser(recover=True)
    etree.fromstring(content, parser)
    return list(parser.error_log)


def _tree(content: bytes, recover: bool) -> etree._Element:
    return etree.fromstring(content, _parser(recover))


def _parser(recover: bool) -> etree.XMLParser:
    return etree.XMLParser(resolve_entities=False, no_network=True, recover=recover)


def _without_what_stands_first(content: bytes, report: Report) -> bytes:
    """Without blank lines or comments before the declaration, where XML allows none."""
    mark = b"\xef\xbb\xbf" if content.startswith(b"\xef\xbb\xbf") else b""
    content = content.removeprefix(mark)
    before = _BEFORE_DECLARATION.match(content)
    if before is None or before.end() == 0:
        return mark + content
    report.lines_before = content[: before.end()].count(b"\n")
    report.warn(
        "xml", None, "line 1: blank lines or comments stand before the declaration <?xml; passed over"
    )
    return content[before.end() :]


def _as_utf8(content: bytes, report: Report) -> bytes:
    """Latin-1 read as such, where a file is neither what it declares nor UTF-8."""
    report.warn("xml", None, "not in UTF-8 as it should be; read as Latin-1")
    declared = _DECLARATION.match(content)
    return content[declared.end() if declared else 0 :].decode("latin-1").encode("utf-8")
