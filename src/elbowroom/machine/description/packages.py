"""Where the files that a description names lie: `package://`, `model://`, `file://`, or a path beside it."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple
from urllib.parse import unquote

from lxml import etree

SEARCH_LEVELS = 8
"""How many folders above the URDF are searched for the files of a package."""
CRAWL_LEVELS = 3
"""How deep packages lie below a folder of `ROS_PACKAGE_PATH`."""
CRAWLED = 20_000
"""At most so many folders are looked at below one folder of it."""
FOLDERS_OF_PACKAGES = (
    "ROS_PACKAGE_PATH",
    "GAZEBO_MODEL_PATH",
    "GZ_SIM_RESOURCE_PATH",
    "IGN_GAZEBO_RESOURCE_PATH",
)
"""Variables of the environment that list folders of packages."""
INSTALLED = ("AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH", "CMAKE_PREFIX_PATH")
"""Variables that list folders in which `share/` holds packages."""

_OF_NO_ROBOT = frozenset(
    [
        "all",
        "assets",
        "common",
        "data",
        "example",
        "examples",
        "my",
        "robot",
        "robots",
        "ros",
        "sim",
        "test",
        "tests",
        "urdf",
        "xacro",
    ]
)
"""Folders that are called `urdf_models` and the like hold robots of any name."""
_NAME_OF_A_PACKAGE = re.compile(r"_(description|support|moveit_config|gazebo|bringup|models?)$")


class Found(NamedTuple):
    """A file that a description names, or why there is none.

    Args:
        path: where it lies; None: it is missing.
        text: of a missing file, why, as the end of a sentence; of one that was found without its package's folder,
            that it was.
    """

    path: Path | None
    text: str = ""


class Packages:
    """Finds what a description names.

    `package://name/rest` is `rest` in the package `name`: a folder of that name, or one whose `package.xml` says so. It
    is looked for in `package_dirs`, then in the folders above the URDF, then where ROS keeps packages. Where there is
    none, the robot may have been copied out of it: the same file without the first parts of its path counts too, unless
    it lies in a package of another name.

    Args:
        urdf: the file that names them.
        package_dirs: folders that hold packages, or are packages.
    """

    def __init__(self, urdf: Path, package_dirs: Sequence[Path] = ()) -> None:
        self.urdf = urdf
        self.package_dirs = tuple(package_dirs)
        self._above = tuple(urdf.resolve().parents)[:SEARCH_LEVELS]
        self._folders: dict[str, Path | None] = {}
        self._taken: dict[Path, str] = {}
        self._named: set[str] = set()
        self._manifests: dict[Path, str | None] = {}
        self._crawls: dict[Path, tuple[Path, ...]] = {}

    def expect(self, filenames: Iterable[str]) -> None:
        """Takes note of the packages that a description names: none of them stands in for another."""
        for filename in filenames:
            scheme, _, rest = filename.strip().partition("://")
            if scheme in ("package", "model"):
                self._named.add(rest.lstrip("/").partition("/")[0])

    def find(self, filename: str) -> Found:
        """The file that a description means by a name."""
        filename = filename.strip()
        if not filename:
            return Found(None, "has no filename")
        scheme, colon, rest = filename.partition("://")
        if not colon:
            if filename.startswith("file:"):
                return _existing(Path(unquote(filename.removeprefix("file:"))))
            return self._beside(filename.replace("\\", "/"))
        if scheme == "file":
            return self._of_url(rest)
        if scheme in ("package", "model"):
            rest = rest.replace("\\", "/")
            path = PurePosixPath(rest.lstrip("/"))
            nameless = len(path.parts) == 1 or rest.startswith("/")
            found = self._nameless(path) if nameless and ".." not in path.parts else None
            return self._in_package(path) if found is None else found
        return Found(None, f"{scheme}:// is not read; allowed are package://, model://, file:// and paths")

    def folder(self, name: str) -> Path | None:
        """The folder of a package; None: there is none."""
        if name not in self._folders:
            found = list(self._candidates(name))
            with_manifest = [folder for folder in found if self._name_of(folder) is not None]
            self._folders[name] = next(iter(with_manifest or found), None)
        return self._folders[name]

    def folder_like(self, name: str) -> Path | None:
        """A folder above the URDF that is called as the robot of a package is: the robot was copied out of it."""
        without = (folder for folder in self._above if self._name_of(folder) is None)
        return next((folder for folder in without if _stem(folder.name) == _stem(name)), None)

    def not_found(self, name: str) -> str:
        """That there is no package of a name, where it was looked for, and what to do."""
        looked = [f"in {folder}" for folder in self.package_dirs] + ["in the folders above the URDF"]
        looked += [
            f"in {variable}" for variable in (*FOLDERS_OF_PACKAGES, *INSTALLED) if os.environ.get(variable)
        ]
        return f"no package {name!r} {', '.join(looked)}; {_advice(name)}"

    def _of_url(self, rest: str) -> Found:
        """`file://`: an absolute path, its special characters written in percent."""
        rest = rest.removeprefix("localhost") if rest.startswith("localhost/") else rest
        for text in (rest, unquote(rest)):
            path = Path(text.removeprefix("/") if text[2:3] == ":" else text)
            if not path.is_absolute():
                path = self.urdf.parent / path
            if path.is_file():
                return Found(path)
        return _existing(path)

    def _beside(self, filename: str) -> Found:
        """A path relative to the URDF, else to one of `package_dirs`, else to the top of the URDF's own package."""
        for text in (filename, unquote(filename)):
            for folder in (self.urdf.parent, *self.package_dirs):
                if (folder / text).is_file():
                    return Found(folder / text)
            for folder in self._own_package() if len(PurePosixPath(text).parts) > 1 else ():
                if (folder / text).is_file():
                    return Found(folder / text, f"not beside the URDF; such files are taken from {folder}")
        return _existing(self.urdf.parent / filename)

    def _own_package(self) -> Iterator[Path]:
        """The folders above the URDF's that belong to the same robot: two at most, none above a manifest."""
        for folder, above in zip(self._above[:2], self._above[1:3], strict=False):
            if self._name_of(folder) is not None:
                return
            yield above

    def _nameless(self, path: PurePosixPath) -> Found | None:
        """`package:///rest`, as onshape-to-robot writes where no package is named: beside the URDF, if it is there."""
        for spelt in (str(path), unquote(str(path))):
            if (self.urdf.parent / spelt).is_file():
                return Found(
                    self.urdf.parent / spelt, "names no package; such files are taken from beside the URDF"
                )
        return None

    def _in_package(self, path: PurePosixPath) -> Found:
        parts = path.parts
        if ".." in parts or len(parts) < 2 or path.is_absolute():
            return Found(None, "must be a package's name and a path inside it")
        name, rest = parts[0], parts[1:]
        folder = self.folder(name)
        if folder is not None:
            for candidate in self._candidates(name):
                for spelt in (candidate.joinpath(*rest), candidate.joinpath(*map(unquote, rest))):
                    if spelt.is_file():
                        return Found(spelt)
            return _existing(folder.joinpath(*rest))
        return self._copied_out(name, rest)

    def _candidates(self, name: str) -> Iterator[Path]:
        """Folders that are the package of a name, the likeliest first."""
        for folder in (*self.package_dirs, *self._above):
            yield from (at for at in (folder, folder / name) if self._is_package(at, name))
        for variable in INSTALLED:
            shares = (folder / "share" / name for folder in _listed(variable))
            yield from (at for at in shares if self._is_package(at, name))
        for variable in FOLDERS_OF_PACKAGES:
            for folder in _listed(variable):
                yield from (at for at in (folder, *self._below(folder)) if self._is_package(at, name))

    def _is_package(self, folder: Path, name: str) -> bool:
        """Whether a folder is the package of a name: it is called so, or its manifest says so."""
        return folder.is_dir() and (folder.name == name or self._name_of(folder) == name)

    def _name_of(self, folder: Path) -> str | None:
        """The name that a folder's `package.xml` gives its package; None: it has none that can be read."""
        if folder not in self._manifests:
            self._manifests[folder] = _name_in_manifest(folder / "package.xml")
        return self._manifests[folder]

    def _below(self, folder: Path) -> tuple[Path, ...]:
        """Folders below one, as deep as packages lie; none below a package."""
        if folder not in self._crawls:
            found: list[Path] = []
            level = [folder]
            for _ in range(CRAWL_LEVELS):
                parents = [at for at in level if at.is_dir() and self._name_of(at) is None]
                level = [at for parent in parents for at in _folders_in(parent)][: CRAWLED - len(found)]
                found += level
            self._crawls[folder] = tuple(found)
        return self._crawls[folder]

    def _copied_out(self, name: str, rest: tuple[str, ...]) -> Found:
        """The same file without the first parts of its path, if it is surely no other package's."""
        for first in range(max(1, len(rest) - 1)):
            for folder in (*self.package_dirs, *self._above):
                path = folder.joinpath(*rest[first:])
                if not path.is_file():
                    continue
                other = self._other_package(path, name)
                if other:
                    return Found(
                        None, f"is missing; {path} lies in package {other!r}, not {name!r}; {_advice(name)}"
                    )
                self._taken[path.resolve()] = name
                return Found(path, f"no folder of package {name!r}; its files are taken from {folder}")
        return Found(None, f"is missing; {self.not_found(name)}")

    def _other_package(self, path: Path, name: str) -> str | None:
        """The name of another package that a file belongs to, or seems to."""
        for folder in path.resolve().parents:
            manifest = self._name_of(folder)
            if manifest is not None:
                return None if _stem(manifest) == _stem(name) else manifest
            if folder.name != name and (folder.name in self._named or _seems_another(folder, name)):
                return folder.name
        taken = self._taken.get(path.resolve(), name)
        return None if taken == name else taken


def _advice(name: str) -> str:
    return f"name the folder that holds {name} in machine.package_dirs of the site (package_dirs= in Python)"


def _existing(path: Path) -> Found:
    """A file, or that it is missing; a name that differs by capital letters alone is said."""
    if path.is_file():
        return Found(path)
    near = (
        [at.name for at in path.parent.iterdir() if at.name.lower() == path.name.lower()]
        if path.parent.is_dir()
        else []
    )
    return Found(
        None, f"is missing; no file {path}" + (f", but {near[0]}: capital letters count" if near else "")
    )


def _listed(variable: str) -> list[Path]:
    """Folders that a variable of the environment lists."""
    return [Path(text) for text in os.environ.get(variable, "").split(os.pathsep) if text]


def _folders_in(folder: Path) -> list[Path]:
    return sorted(at for at in folder.iterdir() if at.is_dir() and not at.name.startswith("."))


def _seems_another(folder: Path, name: str) -> bool:
    """Whether a folder without a manifest is called, or lies, as a package of another robot does."""
    if not _NAME_OF_A_PACKAGE.search(folder.name) and folder.parent.name != "share":
        return False
    if _stem(folder.name) in _OF_NO_ROBOT:
        return False
    mine, other = sorted((_stem(name), _stem(folder.name)), key=len)
    return not other.startswith(mine)


def _stem(name: str) -> str:
    """What a package's name says of the robot: without its usual ending."""
    return _NAME_OF_A_PACKAGE.sub("", name).replace("-", "_")


def _name_in_manifest(manifest: Path) -> str | None:
    if not manifest.is_file():
        return None
    try:
        root = etree.parse(str(manifest), etree.XMLParser(resolve_entities=False, no_network=True)).getroot()
    except (etree.XMLSyntaxError, OSError):
        return None
    return (root.findtext("name") or "").strip() or None
