"""YAML files: read with care, bounded in size, no aliases, no key twice; written so that they read so."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from elbowroom.errors import SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.files.yaml_comments import said_anew

MAX_YAML_BYTES = 1_000_000

Said = tuple[Path, Mapping[str, Any]]
"""A file, and what was read from it."""


class _Loader(yaml.SafeLoader):
    """SafeLoader that refuses aliases and doubled keys, and reads 1e-3 as a number as YAML 1.2 does."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()
            raise yaml.constructor.ConstructorError(
                None,
                None,
                f"alias *{event.anchor}; write the value out, or use camera_defaults",
                event.start_mark,
            )
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str | int | float | bool) or key in seen:
                problem = "is there twice" if isinstance(key, str | int | float | bool) else "is not a word"
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} {problem}", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


_ANOTHER_NUMBER = re.compile(r"[-+]?0[0-9_]+|.*[0-9]_|.*[0-9]:[0-9]")
"""Numbers that YAML 1.1 reads in base 8 or 60, or with underscores left out: people mean something else."""


def _number(loader: _Loader, node: yaml.ScalarNode) -> int | float:
    if _ANOTHER_NUMBER.match(node.value):
        read = (
            yaml.SafeLoader.construct_yaml_int
            if node.tag.endswith("int")
            else yaml.SafeLoader.construct_yaml_float
        )
        raise yaml.constructor.ConstructorError(
            None,
            None,
            f"{node.value} would be read as {read(loader, node):g}; write a number without leading zeros, colons and "
            "underscores, and a name in quotes",
            node.start_mark,
        )
    if node.tag.endswith("int"):
        return yaml.SafeLoader.construct_yaml_int(loader, node)
    return yaml.SafeLoader.construct_yaml_float(loader, node)


_Loader.add_constructor("tag:yaml.org,2002:int", _number)
_Loader.add_constructor("tag:yaml.org,2002:float", _number)
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+$"),
    list("-+.0123456789"),
)


def read_yaml(path: Path) -> dict[str, Any]:
    """The mapping that a YAML file holds.

    Args:
        path: the file, UTF-8, at most `MAX_YAML_BYTES` long.

    Raises:
        SiteError: missing, a folder, too long, no YAML, an alias, a key that is there twice, or no mapping; one line.
    """
    if path.is_dir():
        raise SiteError(f"{path}: is a folder; name the site file, such as {path / 'site.yaml'}")
    if not path.is_file():
        raise SiteError(f"{path}: no such file; `elbowroom site new {path.name}` writes one to start from")
    size = path.stat().st_size
    if size > MAX_YAML_BYTES:
        raise SiteError(f"{path}: {size:,} bytes, at most {MAX_YAML_BYTES:,} are read; is this a site file?")
    with path.open("rb") as file:
        if file.read(2) in (b"\xff\xfe", b"\xfe\xff"):
            raise SiteError(f"{path}: is written in UTF-16; save it as UTF-8")
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}: " if mark else ""
        raise SiteError(f"{path}: {where}{error.problem}; expected plain YAML") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise SiteError(f"{path}: not YAML in UTF-8 ({' '.join(str(error).split())})") from None
    except RecursionError:
        raise SiteError(f"{path}: nested too deeply for a site file") from None
    except ValueError as error:
        # dates and whole numbers that Python's own constructors refuse
        raise SiteError(f"{path}: a value cannot be read ({error})") from None
    if not isinstance(content, dict):
        raise SiteError(f"{path}: holds {type(content).__name__}, expected keys such as grid and cameras")
    return content


class _Dumper(yaml.SafeDumper):
    """SafeDumper that writes a list out wherever it stands: aliases are refused when the file is read."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def write_yaml(path: Path, content: Mapping[str, Any], head: str, like: Said | None = None) -> Path:
    """Writes a mapping, its keys in their order, whole or not at all.

    Args:
        path: the file.
        content: plain values.
        head: what the first line says, as a comment.
        like: a file that says nearly the same, and what that means, as plain values: its comments stay, the order of
            its keys, and how values stand in it; None: there is none.

    Returns:
        The path.

    Raises:
        InputError: the folder cannot be written to.
    """
    if like is not None:
        path_before, meant = like
        text = said_anew(path_before.read_text(encoding="utf-8"), meant, content)
    else:
        text = yaml.dump(
            dict(content),
            Dumper=_Dumper,
            sort_keys=False,
            allow_unicode=True,
            default_flow_style=None,
            width=110,
        )
    with whole_file(path) as unfinished:
        unfinished.write_text(f"# {head}\n{text}", encoding="utf-8")
    return path
