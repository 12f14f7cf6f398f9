"""Pairs of a machine's links that are not compared: as MoveIt's setup assistant finds them, read from a file."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from lxml import etree

from elbowroom.errors import MachineError
from elbowroom.files.yaml_file import read_yaml
from elbowroom.machine.description.report import first_entity

REASONS = {
    "adjacent": "a joint joins them",
    "always": "they touch in nearly all poses",
    "default": "they touch where all joints are at zero",
    "never": "they came near each other in no pose that was tried",
}
"""Why a pair is not compared."""
MOST_SRDF_BYTES = 5_000_000


@dataclass(frozen=True, slots=True, eq=False)
class OwnLinks:
    """Pairs of links that are not compared, and who says so.

    Args:
        source: name of the file.
        pairs: names of two links, and why, in one word.
        of_others: whether it may name links that a machine does not have: an SRDF is often of several variants.

    Raises:
        MachineError: a link with itself.
    """

    source: str
    pairs: tuple[tuple[str, str, str], ...]
    of_others: bool = False
    _known: frozenset[frozenset[str]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for one, other, _ in self.pairs:
            if one == other:
                raise MachineError(f"{self.source}: link {one} with itself; a pair is two links")
        object.__setattr__(self, "_known", frozenset(frozenset(pair[:2]) for pair in self.pairs))

    def has(self, one: str, other: str) -> bool:
        """Whether a pair of links is one of them, in either order."""
        return frozenset((one, other)) in self._known

    @property
    def said(self) -> str:
        """In one line: how many, for which reasons, by which file."""
        if not self.pairs:
            return (
                f"Pairs of links that are not compared, by {self.source}: none, it names no two of its links"
            )
        counts = Counter(reason for _, _, reason in self.pairs)
        reasons = ", ".join(f"{count} {reason}" for reason, count in sorted(counts.items()))
        return f"Pairs of links that are not compared, by {self.source}: {len(self.pairs)} ({reasons})"

    def among(self, links: Collection[str]) -> "OwnLinks":
        """The same without pairs of links that a machine does not have, where such may be named.

        Args:
            links: names of those that it has.

        Raises:
            MachineError: such a link is named in a file of one machine alone.
        """
        unknown = [name for pair in self.pairs for name in pair[:2] if name not in links]
        if not unknown:
            return self
        if not self.of_others:
            raise MachineError(
                f"{self.source}: link {unknown[0]!r} does not exist: the file is of another machine, or older than "
                "this one"
            )
        return OwnLinks(
            self.source, tuple(pair for pair in self.pairs if pair[0] in links and pair[1] in links), True
        )

    @classmethod
    def all_of(cls, several: Sequence["OwnLinks"]) -> Self:
        """The pairs of several files together; of a pair that two name, the reason of the first.

        Args:
            several: at least one.
        """
        pairs: dict[frozenset[str], tuple[str, str, str]] = {}
        for pair in (pair for own in several for pair in own.pairs):
            pairs.setdefault(frozenset(pair[:2]), pair)
        source = ", ".join(dict.fromkeys(own.source for own in several))
        return cls(source, tuple(pairs.values()), any(own.of_others for own in several))

    def without(self, links: Collection[str]) -> "OwnLinks":
        """The same without the pairs of some links, such as those that were taken off; `links`: their names."""
        pairs = tuple(pair for pair in self.pairs if not set(pair[:2]) & set(links))
        return OwnLinks(self.source, pairs, self.of_others)

    def named(self, prefix: str) -> "OwnLinks":
        """The same with something before all names of links."""
        pairs = tuple((prefix + a, prefix + b, why) for a, b, why in self.pairs)
        return OwnLinks(self.source, pairs, self.of_others)

    @classmethod
    def from_srdf(cls, path: str | Path) -> Self:
        """The pairs that an SRDF's `disable_collisions` name.

        Args:
            path: the file.

        Raises:
            MachineError: missing, no XML, no SRDF, one that is xacro yet, or an entry without two links.
        """
        path = Path(path)
        root = _xml(path)
        if root.tag != "robot":
            raise MachineError(f"{path}: the outermost element is <{root.tag}>, an SRDF has <robot>")
        pairs = []
        for entry in root.iter("disable_collisions"):
            one, other = entry.get("link1"), entry.get("link2")
            if not one or not other:
                raise MachineError(
                    f"{path}: line {entry.sourceline}: disable_collisions without link1 or link2"
                )
            if "${" in one + other:
                raise MachineError(
                    f"{path}: line {entry.sourceline}: link {(one if '${' in one else other)!r}: the file is xacro; "
                    "expand it, as with `xacro FILE > robot.srdf`, and name what comes out"
                )
            if one != other:
                pairs.append((one, other, (entry.get("reason") or "unnamed").lower()))
        if not pairs and root.find("link") is not None:
            raise MachineError(f"{path}: is a URDF; an SRDF has disable_collisions")
        return cls(path.name, tuple(pairs), of_others=True)

    @classmethod
    def from_yaml(cls, path: str | Path) -> Self:
        """The pairs of a file that `elbowroom site own-links` wrote.

        Args:
            path: the file.

        Raises:
            MachineError: missing, not such a file, or a pair that is none.
        """
        path = Path(path)
        if not path.is_file():
            raise MachineError(f"{path}: no such file; `elbowroom site own-links` writes one")
        content = read_yaml(path)
        unknown = sorted(set(content) - {*REASONS, "machine", "poses"})
        if unknown:
            raise MachineError(
                f"{path}: unknown key {unknown[0]}; keys are machine, poses, {', '.join(REASONS)}"
            )
        pairs = []
        for reason in REASONS:
            for pair in content.get(reason) or ():
                if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(n, str) for n in pair):
                    raise MachineError(f"{path}: {reason}: {pair} is no pair of links, such as [tool, post]")
                pairs.append((pair[0], pair[1], reason))
        return cls(path.name, tuple(pairs))

    @staticmethod
    def as_yaml(machine: str, poses: int, found: Mapping[str, Sequence[tuple[str, str]]]) -> str:
        """The text of a file that `from_yaml` reads.

        Args:
            machine: its name.
            poses: how many were tried.
            found: by reason, names of two links.
        """
        lines = [
            "# Pairs of links that are not compared: remove a pair, and it is. Found by `elbowroom site own-links`.",
            f"machine: {machine}",
            f"poses: {poses}",
        ]
        for reason, words in REASONS.items():
            pairs = found.get(reason, ())
            lines += ["", f"# {words}", f"{reason}:" + ("" if pairs else " []")]
            lines += [f"  - [{_quoted(one)}, {_quoted(other)}]" for one, other in pairs]
        return "\n".join(lines) + "\n"


def _quoted(name: str) -> str:
    return "'" + name.replace("'", "''") + "'"


def _xml(path: Path) -> etree._Element:
    if not path.is_file():
        raise MachineError(f"{path}: no such file; expected an SRDF")
    content = path.read_bytes()
    if len(content) > MOST_SRDF_BYTES:
        raise MachineError(
            f"{path}: {len(content) / 1e6:.1f} MB; an SRDF has at most {MOST_SRDF_BYTES / 1e6:g}"
        )
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise MachineError(f"{path}: line {error.lineno}: not XML: {error.msg}") from None
    entity = first_entity(root)
    if entity is not None:
        raise MachineError(
            f"{path}: line {entity.sourceline}: {entity.text} stands for other text (an XML entity), which is not "
            "read: put its content there"
        )
    return root
