"""What is wrong with a site file, in one line: the file, the key, what was found, what is allowed."""

import difflib
import re
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from elbowroom.errors import SiteError

LONGEST_VALUE = 60


def one_line(path: Path, model: type[BaseModel], error: ValidationError) -> SiteError:
    """The first thing that is wrong, and how many more there are.

    Args:
        path: of the site file.
        model: what the file was read as; its keys are those that are allowed.
        error: what pydantic found.
    """
    details = error.errors(include_url=False)
    first = _most_useful(details)
    more = f" ({len(details) - 1} more)" if len(details) > 1 else ""
    location = list(first["loc"])
    if location[0:1] == ["recording"] and location[1:2] and location[1] in LAYOUTS:
        del location[1]  # the tag that pydantic puts there is no key of the file
    if location[0:2] == ["calibration", "world"] and location[2:3] and location[2] in WORLDS:
        del location[2]
    where = key_path(location)
    return SiteError(f"{path}: {f'{where}: ' if where else ''}{_said(first, model, location)}{more}")


def _most_useful(details: Sequence[ErrorDetails]) -> ErrorDetails:
    """The one that most likely is the reason of others: a key that is misspelt, where one is missing."""
    unknown = [each for each in details if each["type"] == "extra_forbidden"]
    commas = [each for each in details if each["type"] == "invalid_key" and isinstance(each["input"], int)]
    if commas:
        return commas[0]
    return unknown[0] if unknown and details[0]["type"] == "missing" else details[0]


LAYOUTS = ("folder", "stampless", "seven_scenes")
"""Kinds of recording."""
WORLDS = ("board", "points", "machine", "camera")
"""What may fix the world's frame."""


def key_path(location: Sequence[Any]) -> str:
    """Keys as people write them: `cameras[1].fx`."""
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


def _said(first: ErrorDetails, model: type[BaseModel], location: Sequence[Any]) -> str:
    found = _short(first["input"])
    context = first.get("ctx", {})
    if first["type"] == "missing":
        return "missing; it must be given"
    if first["type"] == "invalid_key":
        return f"key {found}, allowed: words; in braces a comma parts entries, and decimals have a dot: 0.3, not 0,3"
    if first["type"] == "extra_forbidden":
        allowed = keys_at(model, location[:-1])
        near = difflib.get_close_matches(str(location[-1]), allowed, n=1)
        meant = f" (did you mean {near[0]}?)" if near else ""
        return f"unknown key{meant}, allowed: {', '.join(allowed)}"
    if first["type"] == "value_error":
        return f"found {found}, allowed: {context['error']}"
    if first["type"] in ("union_tag_invalid", "union_tag_not_found"):
        key, words = ("by", WORLDS) if location[:1] == ["calibration"] else ("layout", LAYOUTS)
        return f"found {found}, allowed: a key {key} with {', '.join(words)}"
    if "expected" in context:
        return f"found {found}, allowed: {context['expected']}"
    wanted = first["msg"].removeprefix("Input should be ")
    return f"found {found}, allowed: {wanted[0].lower()}{wanted[1:]}{_hint(first)}"


def _hint(error: ErrorDetails) -> str:
    """What YAML made of what a person wrote, or how it is written instead; nothing where that is plain."""
    value, kind = error["input"], error["type"]
    if kind == "string_type" and isinstance(value, bool):
        return "; YAML reads on, off, yes and no as true and false: write it in quotes"
    if kind == "string_type" and isinstance(value, int | float | date):
        return "; write it in quotes"
    if kind in ("float_type", "int_type") and isinstance(value, str):
        return _hint_of_number(value)
    if kind == "bool_type":
        return ", true or false, without quotes"
    if kind == "tuple_type":
        return ", a list: each on a line after a dash, or in brackets"
    return "; each on a line as key: value, without a dash" if kind == "dict_type" else ""


def _hint_of_number(value: str) -> str:
    text = value.strip()
    if re.fullmatch(r"[-+]?[0-9]+,[0-9]+", text):
        return "; decimals have a dot"
    number = re.match(r"[-+]?[0-9]*\.?[0-9]+(e[-+]?[0-9]+)?", text, re.IGNORECASE)
    if number is None:
        return ""
    return (
        "; write it without quotes"
        if number.end() == len(text)
        else "; a number alone, its unit is in the key's name"
    )


def _short(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST_VALUE else f"{text[: LONGEST_VALUE - 3]}..."


def keys_at(model: type[BaseModel], location: Sequence[Any]) -> list[str]:
    """Names of the keys that a mapping of the file may have, at a place in it."""
    candidates: list[Any] = [model]
    for part in location:
        if isinstance(part, str):
            candidates = [
                inner
                for candidate in candidates
                for field in [candidate.model_fields.get(part)]
                for inner in _models(field.annotation if field else candidate)
            ]
    return list(dict.fromkeys(key for candidate in candidates for key in candidate.model_fields))


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for inner in get_args(annotation) for model in _models(inner)]
