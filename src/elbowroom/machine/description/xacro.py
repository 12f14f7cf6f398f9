"""xacro, the macro language that URDFs are written in: recognised, and expanded where the package xacro is there."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple
from xml.parsers.expat import ExpatError

from lxml import etree

from elbowroom.errors import MachineError, PackageError
from elbowroom.extras import install_command, package
from elbowroom.machine.description.packages import Packages
from elbowroom.machine.description.report import tag_of

OLD_WORDS = {"include", "property", "macro", "insert_block", "arg", "if", "unless"}
"""Elements of xacro that old files write without a prefix, as children of the robot."""
OF_THE_ROBOT = {"link", "joint", "material", "robot"}
"""Expressions are looked for in these elements; elsewhere, in plugins, `$(...)` may be meant as it stands."""
_EXPRESSION = re.compile(r"\$\{|\$\((find|arg|eval|env|optenv|dirname|anon)\b")


class Sign(NamedTuple):
    """Where a file shows that it is xacro, and by what."""

    element: etree._Element
    text: str


class Expanded(NamedTuple):
    """What xacro makes of a file.

    Args:
        content: as UTF-8.
        macros: names of the macros that the file and those that it includes define.
    """

    content: bytes
    macros: frozenset[str]


def first_sign(root: etree._Element) -> Sign | None:
    """The first element, attribute or expression of the xacro language that is left in a file."""
    for element in root.iter(etree.Element):
        if _is_xacro(element.tag) or (element.getparent() is root and tag_of(element) in OLD_WORDS):
            return Sign(element, "is xacro, which is not expanded yet")
        for name, value in element.attrib.items():
            if _is_xacro(str(name)):
                return Sign(element, "an attribute is xacro, which is not expanded yet")
            if _EXPRESSION.search(str(value)) and _of_the_robot(element):
                return Sign(element, "holds an expression of xacro, which is not expanded yet")
    return None


def _is_xacro(name: str) -> bool:
    """Whether a name is of the namespace of xacro, declared or not."""
    namespace, _, local = name.rpartition("}")
    return "xacro" in namespace.lower() or local.startswith("xacro:")


def _of_the_robot(element: etree._Element) -> bool:
    """Whether an element is, or lies in, a link, a joint or a material; the robot itself counts."""
    chain = [element, *element.iterancestors()]
    return tag_of(chain[-2] if len(chain) > 1 else chain[0]) in OF_THE_ROBOT


def expanded(path: Path, sign: str, packages: Packages, arguments: Mapping[str, str]) -> Expanded:
    """What xacro makes of a file.

    Args:
        path: the file.
        sign: a sentence that shows that it is xacro.
        packages: where `$(find ...)` looks.
        arguments: values of its arguments.

    Raises:
        MachineError: the package xacro is not installed, or refuses the file.
    """
    try:
        xacro = package("xacro")
    except PackageError:
        raise MachineError(
            f"{sign}; expand it first (xacro {path.name} > robot.urdf), or let it be expanded here: "
            f"{install_command('xacro')}"
        ) from None
    missing_packages: list[MachineError] = []
    before = len(xacro.all_includes)
    given = _Arguments({name: str(value) for name, value in arguments.items()})
    try:
        with _finding(packages, missing_packages):
            document = xacro.process_file(str(path), mappings=given)
    except ExpatError as error:
        raise MachineError(f"{path}: xacro cannot expand it: not XML: {error}") from error
    except (
        Exception
    ) as error:  # xacro raises its own exceptions and those of the expressions that it evaluates
        if missing_packages:
            raise missing_packages[0] from error
        missing = re.search(r"Undefined substitution argument (\w+)", str(error))
        hint = f"; give {missing[1]} in xacro_arguments" if missing else ""
        raise MachineError(f"{path}: xacro cannot expand it: {' '.join(str(error).split())}{hint}") from error
    for name in arguments:
        if name not in given.asked:
            known = ", ".join(sorted(given.asked)) or "none"
            raise MachineError(
                f"{path}: xacro_arguments: the file has no argument {name}; arguments are {known}"
            )
    files = dict.fromkeys([str(path), *map(str, xacro.all_includes[before:])])
    macros = frozenset(name for file in files for name in _macros(Path(file)))
    return Expanded(bytes(document.toprettyxml(indent="  ", encoding="utf-8")), macros)


def _macros(path: Path) -> Iterator[str]:
    """Names of the macros that a file defines; none where it is no XML, as a file of values is."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, recover=True)
    with suppress(OSError, etree.XMLSyntaxError):
        root = etree.fromstring(path.read_bytes(), parser)
        for element in () if root is None else root.iter(etree.Element):
            if tag_of(element) == "macro":
                yield (element.get("name") or "").removeprefix("xacro:")


class _Arguments(dict[str, str]):
    """Values of arguments, and the names that the files ask for: those that they declare or use."""

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


@contextmanager
def _finding(packages: Packages, missing: list[MachineError]) -> Iterator[None]:
    """Lets `$(find ...)` look where meshes are looked for; it knows ROS' own index alone.

    Args:
        packages: where to look.
        missing: takes an error for each package that is not there; xacro itself hides them in its own.
    """

    def folder_of(name: str) -> str:
        folder = packages.folder(name) or packages.folder_like(name)
        if folder is None:
            missing.append(MachineError(f"{packages.urdf}: $(find {name}): {packages.not_found(name)}"))
            raise missing[-1]
        return str(folder)

    inner = package("xacro.substitution_args")
    kept = inner._eval_find
    inner._eval_find, inner._eval_dict["find"] = folder_of, folder_of
    try:
        yield
    finally:
        inner._eval_find, inner._eval_dict["find"] = kept, kept
