"""Descriptions of robots below folders, and the packages that they were published in."""

from collections.abc import Iterator, Sequence
from email.parser import HeaderParser
from pathlib import Path
from typing import NamedTuple

from elbowroom.errors import InputError

SUFFIXES = (".urdf", ".xacro")


class Published(NamedTuple):
    """A file of a package.

    Args:
        path: where it lies.
        root: the folder that the package was unpacked into.
        package, version: as the package says of itself; "" where it says nothing.
    """

    path: Path
    root: Path
    package: str
    version: str

    @property
    def name(self) -> str:
        """Its path inside the package's folder."""
        return self.path.relative_to(self.root).as_posix()


def published(folders: Sequence[Path]) -> Iterator[Published]:
    """URDF and xacro files below folders, sorted; each once.

    Args:
        folders: in which packages were unpacked or installed.

    Raises:
        InputError: a folder that is not there, or no such file in any of them.
    """
    found: dict[Path, Published] = {}
    for folder in folders:
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder; expected one with URDF files")
        for path in sorted(folder.rglob("*")):
            if path.suffix.lower() in SUFFIXES and path.is_file():
                found.setdefault(path.resolve(), _of(path, folder))
    if not found:
        raise InputError(f"{', '.join(map(str, folders))}: no URDF and no xacro file below")
    yield from found.values()


def _of(path: Path, folder: Path) -> Published:
    """With the package whose list of files names it."""
    for root in path.parents:
        for manifest in sorted(root.glob("*.dist-info/RECORD")):
            relative = path.relative_to(root).as_posix()
            if relative in _listed(manifest):
                about = HeaderParser().parsestr((manifest.parent / "METADATA").read_text(encoding="utf-8"))
                return Published(path, root, str(about["Name"]), str(about["Version"]))
    return Published(path, folder, "", "")


_RECORDS: dict[Path, frozenset[str]] = {}


def _listed(manifest: Path) -> frozenset[str]:
    """The descriptions that a package's list of files names."""
    if manifest not in _RECORDS:
        lines = manifest.read_text(encoding="utf-8").splitlines()
        names = (line.rsplit(",", 2)[0].strip('"') for line in lines)
        _RECORDS[manifest] = frozenset(name for name in names if name.lower().endswith(SUFFIXES))
    return _RECORDS[manifest]
