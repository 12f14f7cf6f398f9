"""Which files a bag consists of: a folder with metadata.yaml, as `ros2 bag record` writes it, or a file alone."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from elbowroom.errors import BagError, SiteError
from elbowroom.files.yaml_file import read_yaml
from elbowroom.site.paths import inside

METADATA = "metadata.yaml"
ENDINGS = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")
ROS1_MAGIC = b"#ROSBAG V"
MOST_FILES = 10_000


class Parts(NamedTuple):
    """The files of a bag, and what is wrong with how they are named.

    Args:
        files: in the order in which they were written; all are there.
        notes: what is missing.
    """

    files: Sequence[Path]
    notes: Sequence[str]


def parts_of(path: Path) -> Parts:
    """The files of a bag.

    Args:
        path: the folder or the file.

    Raises:
        BagError: there is none, or a metadata.yaml that is none.
    """
    if path.is_file():
        if path.name == METADATA:
            raise BagError(f"{path}: describes a bag; name the folder that it lies in, {path.parent}")
        return Parts([path], [])
    if not path.is_dir():
        raise BagError(
            f"{path}: no such file or folder; a bag is the folder of `ros2 bag record`, or an .mcap file"
        )
    said = path / METADATA
    if not said.is_file():
        found = sorted((p for p in path.iterdir() if p.name.endswith(ENDINGS)), key=_natural)
        if not found:
            old = sorted(path.glob("*.bag"))
            more = (
                f"; {old[0].name} is a bag of ROS 1: rosbags-convert --src {old[0]} --dst {old[0].stem}"
                if old
                else ""
            )
            raise BagError(f"{path}: no bag: neither {METADATA} nor files *.mcap or *.db3{more}")
        note = f"{path}: {METADATA} is missing, as where recording was killed; {len(found)} files are read without it"
        return Parts(found, [note])
    return _named(path, said)


def _named(folder: Path, said: Path) -> Parts:
    try:
        content = read_yaml(said).get("rosbag2_bagfile_information")
        names = content["relative_file_paths"] if isinstance(content, dict) else None
    except (SiteError, KeyError) as error:
        raise BagError(
            f"{said}: not what `ros2 bag record` writes ({error}); without it the files are read by name"
        ) from None
    if not isinstance(names, list) or not names or len(names) > MOST_FILES:
        raise BagError(
            f"{said}: names no files in relative_file_paths; without it the files are read by name"
        )
    files, notes = [], []
    for name in map(str, names):
        # bags of 2019 name files with the folder before them
        relative = inside(folder, name)
        place = next((p for p in (folder / relative, folder / Path(relative).name) if p.is_file()), None)
        if place is None:
            notes.append(f"{folder / name}: named in {METADATA}, and not there")
        else:
            files.append(place)
    if not files:
        raise BagError(f"{folder / names[0]}: named in {METADATA}, and not there; copy the bag again")
    return Parts(files, notes)


def _natural(path: Path) -> list[tuple[int, str]]:
    """Names in order of their numbers: _2 before _10."""
    return [(int(word), "") if word.isdigit() else (0, word) for word in re.split(r"([0-9]+)", path.name)]
