"""A bag of ROS 2, opened: its topics, and their messages in the order in which they were received."""

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Self

from elbowroom.errors import BagError
from elbowroom.files.content import head_of, what_it_is
from elbowroom.sources.bags import mcap_file, sqlite_file
from elbowroom.sources.bags.cdr import HEADER_BYTES, Cdr, frame_at_head, stamp_at_head
from elbowroom.sources.bags.mcap_file import McapFile
from elbowroom.sources.bags.messages import header_of
from elbowroom.sources.bags.metadata import ROS1_MAGIC, parts_of
from elbowroom.sources.bags.sqlite_file import SqliteFile
from elbowroom.sources.bags.storage import Storage, Stored, Topic
from elbowroom.sources.bags.unpacked import is_zstd, unpack_file

LEFT_ON_DISK = 1 << 30
"""What a compressed file unpacks to leaves so much of the disk free [bytes]."""


class Bag:
    """A bag, looked through. Messages are read when they are asked for.

    Args:
        path: the folder of `ros2 bag record`, or a file *.mcap, *.db3, or one of these with .zstd.

    Raises:
        BagError: no bag, or one of which nothing can be read.
        PackageError: it is compressed, and the package that unpacks it is not installed.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._parts: list[Storage] = []
        parts = parts_of(path)
        found = list(parts.notes)
        try:
            for number, file in enumerate(parts.files):
                part, notes = self._opened(file, number)
                self._parts.append(part)
                found += [*notes, *part.notes]
        except BaseException:
            self.close()
            raise
        self.notes: tuple[str, ...] = tuple(found)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    @cached_property
    def topics(self) -> dict[str, Topic]:
        """All topics by name, in order of their names."""
        found: dict[str, Topic] = {}
        for part in self._parts:
            for topic in part.topics:
                known = found.setdefault(topic.name, topic)
                if known != topic:
                    raise BagError(
                        f"{self.path}: topic {topic.name} is {known.type} ({known.encoding}) and {topic.type} "
                        f"({topic.encoding}); name it once, or record anew"
                    )
        return dict(sorted(found.items()))

    def of_type(self, *types: str) -> list[str]:
        """Names of the topics of some types."""
        return [name for name, topic in self.topics.items() if topic.type in types]

    def messages(self, topic: str) -> Sequence[Stored]:
        """The messages of a topic by the time at which they were received.

        Raises:
            BagError: there is no such topic, or its messages are not written as ROS 2 does.
        """
        self.require(topic)
        stored = [message for part in self._parts for message in part.messages(topic)]
        return sorted(stored, key=lambda message: message.received_ns)

    def count(self, topic: str) -> int:
        """How many messages a topic has, however they are written."""
        return sum(len(part.messages(topic)) for part in self._parts)

    def read(self, stored: Stored) -> bytes:
        """The bytes of a message.

        Raises:
            BagError: they are damaged.
        """
        return self._parts[stored.part].read(stored)

    def stamp_ns(self, stored: Stored) -> int:
        """The stamp of a message that begins with a header [ns]; 0: it has none.

        Raises:
            BagError: it is damaged, or does not begin so.
        """
        stamp = stored.stamp_ns
        if stamp is None:
            stamp = stamp_at_head(self.read(stored)[:16])
        if stamp is None:
            raise BagError(f"{self.path}: a message of {stored.size} bytes has no header")
        return stamp

    def frame(self, stored: Stored) -> str:
        """The frame of a message that begins with a header, without a slash in front; "": it names none.

        Raises:
            BagError: it is damaged, or does not begin so.
        """
        frame = stored.frame
        if frame is None:
            data = self.read(stored)
            frame = frame_at_head(data[:HEADER_BYTES])
            if frame is None:
                frame = header_of(Cdr(data, f"{self.path}: a message of {stored.size} bytes")).frame
        return frame.removeprefix("/")

    def require(self, topic: str) -> Topic:
        """A topic by its name; raises as `messages`."""
        found = self.topics.get(topic)
        if found is None:
            known = ", ".join(self.topics) or "none"
            raise BagError(f"{self.path}: no topic {topic}; topics are {known}")
        if found.encoding != "cdr":
            raise BagError(
                f"{self.path}: messages of {topic} are written as {found.encoding!r}; those of ROS 2, cdr, are read"
            )
        return found

    def all(self, types: Sequence[str]) -> Iterator[tuple[str, Stored]]:
        """Topic and message of all topics of some types, in the order of their topics."""
        for topic in self.of_type(*types):
            for message in self.messages(topic):
                yield topic, message

    def close(self) -> None:
        """Lets go of all files."""
        for part in self._parts:
            part.close()
        if self._folder is not None:
            with suppress(OSError):
                self._folder.cleanup()
            self._folder = None

    def _opened(self, file: Path, number: int) -> tuple[Storage, list[str]]:
        """A file by its first bytes, whatever its name is, and what is wrong with how it is compressed."""
        try:
            with file.open("rb") as opened:
                start = opened.read(16)
        except OSError as error:
            raise BagError(f"{file}: cannot be read ({error.strerror})") from None
        if start[:4] and is_zstd(start):
            return self._unpacked(file, number)
        if start.startswith(mcap_file.MAGIC):
            return McapFile(file, number), []
        if start.startswith(sqlite_file.MAGIC):
            return SqliteFile(file, number), []
        if start.startswith(ROS1_MAGIC):
            raise BagError(
                f"{file}: a bag of ROS 1; convert it: rosbags-convert --src {file.name} --dst {file.stem}"
            )
        found = what_it_is(head_of(file))
        raise BagError(
            f"{file}: neither MCAP nor a database of rosbag2; "
            + (f"it is {found}" if found else "is it cut off in its first bytes?")
        )

    def _unpacked(self, file: Path, number: int) -> tuple[Storage, list[str]]:
        """A file that is compressed as a whole, unpacked into a folder that vanishes with the bag."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="elbowroom-bag-")
        into = Path(self._folder.name) / f"{number}-{file.stem}"
        most = max(shutil.disk_usage(into.parent).free - LEFT_ON_DISK, 0)
        damage = unpack_file(file, into, most)
        with into.open("rb") as opened:
            if is_zstd(opened.read(4)):
                raise BagError(f"{file}: compressed twice")
        part, _ = self._opened(into, number)
        note = [] if damage is None else [f"{file}: cut off or damaged ({damage}); it is read up to there"]
        return part, note
