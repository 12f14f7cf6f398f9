"""Paths as site files write them: relative to the file, with variables of the environment."""

import os
import re
from pathlib import Path

from elbowroom.errors import SiteError

_VARIABLE = re.compile(r"\$\{([A-Za-z_][A-Za-z0-9_]*)(?::-([^}]*))?\}")


def expand(text: str, beside: Path) -> Path:
    """The path that a site file means.

    `${NAME}` stands for a variable of the environment, `${NAME:-otherwise}` for it or else for the text
    given. What is relative lies beside the site file; a variable's own relative value, in the working
    directory.

    Args:
        text: as written.
        beside: the site file's folder.

    Raises:
        SiteError: a variable that is not set and has no other text, or a `$` that is none of these.
    """

    def value_of(match: re.Match[str]) -> str:
        name, otherwise = match.groups()
        value = os.environ.get(name)
        if value:
            return str(Path(value).absolute()) if match.start() == 0 else value
        if otherwise is None:
            raise SiteError(f"{text}: ${{{name}}} is not set; set it, or write ${{{name}:-a/default}}")
        return otherwise

    expanded = _VARIABLE.sub(value_of, text)
    if "${" in expanded:
        raise SiteError(f"{text}: variables are written ${{NAME}} or ${{NAME:-default}}")
    return Path(os.path.normpath(beside / expanded))


def led_from(text: str, old: Path, new: Path) -> str:
    """The text of a path that leads from another folder to the same place; a variable at its beginning stays.

    Args:
        text: as written in a file of the old folder.
        old, new: the folders of two site files.

    Raises:
        SiteError: as `expand`.
    """
    if old.absolute() == new.absolute():
        return text
    begins = _VARIABLE.match(text)
    if begins is None:
        return os.path.relpath(expand(text, old.absolute()), new)
    name, otherwise = begins.groups()
    if otherwise is None or Path(otherwise).is_absolute():
        return text
    led = os.path.relpath(expand(otherwise, old.absolute()), new)
    return f"${{{name}:-{led}}}{text[begins.end() :]}"


def existing_folder(text: str, beside: Path) -> Path:
    """As `expand`, and there must be a folder of that name.

    Raises:
        SiteError: there is none; names the variable that would point elsewhere.
    """
    folder = expand(text, beside)
    if not folder.is_dir():
        names = _VARIABLE.findall(text)
        advice = f"set {names[0][0]} to where it lies" if names else "correct the path or fetch the recording"
        advice = foreign(text) or advice
        raise SiteError(f"no folder {folder} (written {text}); {advice}")
    return folder


def existing_bag(text: str, beside: Path) -> Path:
    """As `expand`, and there must be a folder or a file of that name.

    Raises:
        SiteError: there is none.
    """
    place = expand(text, beside)
    if not place.exists():
        advice = foreign(text) or "correct the path or fetch the bag"
        raise SiteError(f"no folder or file {place} (written {text}); {advice}")
    return place


def foreign(text: str) -> str:
    """What to write instead of a path that another program would read; "": it is none.

    Args:
        text: as written.
    """
    if text.startswith("~"):
        return "~ is not read: write ${HOME}"
    named = re.match(r"\$([A-Za-z_]\w*)|%([A-Za-z_]\w*)%", text)
    if named is not None:
        return f"a variable is written ${{{named[1] or named[2]}}}"
    if re.match(r"[a-z]+://", text):
        return "a path is meant, without what stands before ://"
    return "write / for \\" if "\\" in text and os.sep == "/" else ""


def inside(folder: Path, text: str) -> str:
    """`text` if it is a relative path or pattern that stays within a folder.

    Raises:
        SiteError: it is absolute or climbs out.
    """
    if not text or Path(text).is_absolute() or ".." in Path(text).parts or "\\" in text:
        raise SiteError(
            f"{text!r} does not stay inside {folder}; give a path relative to that folder, without .."
        )
    return text
