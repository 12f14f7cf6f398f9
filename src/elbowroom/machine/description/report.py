"""What is found in a robot description: errors and warnings that name file, line, element, link or joint."""

from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from elbowroom.errors import MachineError
from elbowroom.finding import Finding

LONGEST_ELEMENT = 70
"""So many characters of an element are quoted."""


@dataclass(slots=True)
class Report:
    """Names places in one description, and keeps what is found there.

    Args:
        path: the file.
        expanded: whether its elements are what xacro made of it: lines are then none of the file's.
        lines_before: lines that were left out before the first element that was parsed.
        findings: what was found and passes, each in one line; grows.
    """

    path: Path
    expanded: bool = False
    lines_before: int = 0
    findings: list[Finding] = field(default_factory=list)

    def error(self, element: etree._Element | None, text: str) -> MachineError:
        """What is wrong at an element; None: with the file as a whole."""
        return MachineError(self.said(element, text))

    def warn(self, kind: str, element: etree._Element | None, text: str) -> None:
        """Keeps a finding that lets the file pass.

        Args:
            kind: of thing, one or two words.
            element: where; None: the file as a whole.
            text: what was found and how it is taken.
        """
        owner = None if element is None else owner_of(element)
        about = () if owner is None else (owner.get("name", ""),)
        finding = Finding(kind, about, self.said(element, text), stops=False)
        if finding not in self.findings:
            self.findings.append(finding)

    def said(self, element: etree._Element | None, text: str) -> str:
        """A sentence with its place: file, line, link or joint, element."""
        if element is None:
            return f"{self.path}: {text}"
        line = (element.sourceline or 0) + self.lines_before
        place = f"{self.path}: {'expanded, ' if self.expanded else ''}line {line}: "
        owner = owner_of(element)
        if owner is not None:
            named = owner.get("name")
            place += f"{tag_of(owner)} {named}: " if named else f"a {tag_of(owner)} without a name: "
        return f"{place}{'' if element is owner else quoted(element) + ': '}{text}"


def tag_of(element: etree._Element) -> str:
    """Name of an element without namespace and prefix; nothing for a comment."""
    tag = element.tag
    return tag.rpartition("}")[2].rpartition(":")[2] if isinstance(tag, str) else ""


def is_own(element: etree._Element) -> bool:
    """Whether an element is of the description itself, not of another program's namespace.

    Its own namespace is that of the outermost element, if that has one, or none.
    """
    namespace, _, name = str(element.tag).rpartition("}")
    of_root = str(element.getroottree().getroot().tag).rpartition("}")[0]
    return ":" not in name and namespace in ("", of_root)


def first_entity(root: etree._Element) -> etree._Element | None:
    """The first place at which text stands for other text (`&name;`): a parser keeps the place and reads nothing there.

    Args:
        root: of a tree that was parsed without resolving entities.
    """
    return next(iter(root.iter(etree.Entity)), None)


def owner_of(element: etree._Element) -> etree._Element | None:
    """The link or joint that an element belongs to, or is."""
    found = None
    for at in (element, *element.iterancestors()):
        if tag_of(at) in ("link", "joint") and at.getparent() is not None:
            found = at
    return found


def quoted(element: etree._Element) -> str:
    """An element's opening tag as it stands in the file, cut if it is long."""
    prefix = f"{element.prefix}:" if element.prefix else ""
    attributes = "".join(f' {name.rpartition("}")[2]}="{value}"' for name, value in element.attrib.items())
    text = " ".join(f"{prefix}{str(element.tag).rpartition('}')[2]}{attributes}".split())
    return f"<{text if len(text) <= LONGEST_ELEMENT else text[: LONGEST_ELEMENT - 3] + '...'}>"
