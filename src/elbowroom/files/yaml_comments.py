"""A YAML text with other values, its comments and the order of its keys kept."""

import io
import re
from collections.abc import Mapping
from typing import Any

_HEAD = re.compile(r"\A# .*by `elbowroom .*\n")
"""A first line that says what wrote the text: another one takes its place."""


def said_anew(text: str, meant: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    """The text, with each key as the content says it if that is not what it means already.

    What the content does not say is left out. Lists of mappings that have names are matched by name.

    Args:
        text: YAML that holds a mapping.
        meant: what was read from it, as plain values: "tof" may mean four numbers, and stays a word.
        content: what it shall say, as plain values.
    """
    # needed where a file is written again, and slow to load
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.width = 110
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.preserve_quotes = True
    document = yaml.load(_HEAD.sub("", text))
    _say(document, meant, content)
    told = io.StringIO()
    yaml.dump(document, told)
    return told.getvalue()


def _say(document: Any, meant: Mapping[str, Any], content: Mapping[str, Any]) -> None:
    """Makes a mapping of the document say what the content says."""
    for key in [key for key in document if key not in content]:
        del document[key]
    for key, value in content.items():
        if key in document and key in meant and meant[key] == value:
            continue
        if key in document and isinstance(value, Mapping) and isinstance(document[key], Mapping):
            _say(document[key], meant.get(key, {}), value)
        elif key in document and _are_named(value) and _are_named(document[key]):
            _say_named(document[key], meant[key], value)
        else:
            document[key] = _laid_out(value)


def _say_named(entries: Any, meant: list[Mapping[str, Any]], content: list[Mapping[str, Any]]) -> None:
    """Makes a list of mappings with names say what the content says; those that stay keep their comments."""
    known = {entry["name"]: entry for entry in entries}
    means = {entry["name"]: entry for entry in meant}
    for position in reversed(range(len(entries))):
        if entries[position]["name"] not in {entry["name"] for entry in content}:
            del entries[position]
    for entry in content:
        if entry["name"] in known:
            _say(known[entry["name"]], means[entry["name"]], entry)
        else:
            entries.append(_laid_out(entry))


def _are_named(value: Any) -> bool:
    return (
        isinstance(value, list)
        and bool(value)
        and all(isinstance(entry, Mapping) and "name" in entry for entry in value)
    )


def _laid_out(value: Any) -> Any:
    """A value that is new: lists of numbers and of words stand in one line."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(value, Mapping):
        return CommentedMap({key: _laid_out(item) for key, item in value.items()})
    if isinstance(value, list):
        laid = CommentedSeq([_laid_out(item) for item in value])
        if not any(isinstance(item, list | Mapping) for item in value):
            laid.fa.set_flow_style()
        return laid
    return value
