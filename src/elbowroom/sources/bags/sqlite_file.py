"""A file of rosbag2's storage sqlite3: tables `topics` and `messages`."""

import sqlite3
import threading
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path

from elbowroom.errors import BagError
from elbowroom.sources.bags.cdr import HEADER_BYTES, frame_at_head, stamp_at_head
from elbowroom.sources.bags.storage import LARGEST_MESSAGE, Stored, Topic
from elbowroom.sources.bags.unpacked import is_zstd, unpacked

MAGIC = b"SQLite format 3\x00"
COLUMNS = {
    "topics": {"id", "name", "type", "serialization_format"},
    "messages": {"id", "topic_id", "timestamp", "data"},
}
MOST_TOPICS = 10_000
FAULTS = sqlite3.Error, UnicodeDecodeError, MemoryError
"""Of a damaged file; the second where the fault's own text quotes what is no UTF-8; the third where a row says that it
is almost 4 GiB long: SQLite's own sum of its pages wraps to none, and it says that there is no memory."""


class SqliteFile:
    """A file of this storage (`Storage`).

    Args:
        path: the file.
        part: its number in the bag.

    Raises:
        BagError: it is no database, or has not the tables of a bag.
    """

    def __init__(self, path: Path, part: int = 0) -> None:
        self.path, self.part = path, part
        self.notes: list[str] = []
        self._lock = threading.Lock()
        self._stored: dict[str, list[Stored]] = defaultdict(list)
        self._base = _opened(path)
        try:
            self._require_tables()
            self._names = self._read_topics()
            self._look_through()
        except FAULTS as error:
            self.close()
            raise BagError(f"{path}: a database that cannot be read ({_said(error)}){_hint(error)}") from None
        except BaseException:
            self.close()
            raise

    @property
    def topics(self) -> Sequence[Topic]:
        """All topics."""
        return list(self._names.values())

    def messages(self, topic: str) -> Sequence[Stored]:
        """The messages of a topic."""
        return self._stored.get(topic, [])

    def read(self, stored: Stored) -> bytes:
        """The bytes of a message; raises as `Storage` says."""
        what = f"{self.path}: message {stored.place}"
        try:
            with self._lock, closing(self._blob(stored.place)) as blob:
                data = blob.read()
        except FAULTS as error:
            raise BagError(f"{what}: cannot be read ({_said(error)})") from None
        return unpacked(data, "zstd", LARGEST_MESSAGE, what) if is_zstd(data) else data

    def close(self) -> None:
        """Lets go of the file."""
        self._base.close()

    def _require_tables(self) -> None:
        """Real tables, and no views, which could be made to never end."""
        for table, needed in COLUMNS.items():
            kind = self._base.execute("select type from sqlite_master where name = ?", (table,)).fetchone()
            there = {str(row[1]) for row in self._base.execute(f"pragma table_info({table})")}
            if kind is None or kind[0] != "table" or not needed <= there:
                raise BagError(
                    f"{self.path}: no table {table} as rosbag2 writes it; is this a bag of `ros2 bag record`?"
                )

    def _read_topics(self) -> dict[int, Topic]:
        rows = self._base.execute(
            "select id, name, type, serialization_format from topics limit ?", (MOST_TOPICS,)
        )
        return {
            int(number): Topic(str(name)[:1000], str(kind)[:1000], str(encoding)[:100])
            for number, name, kind, encoding in rows
            if isinstance(number, int)
        }

    def _look_through(self) -> None:
        """Finds the messages in the order of their rows, which goes as far as a file that was cut off goes."""
        try:
            for number, topic_id, received, size in self._rows():
                topic = self._names.get(topic_id)
                if topic is not None and 0 <= received < 2**63 and 0 < size <= LARGEST_MESSAGE:
                    stamp, frame = self._head(number, size)
                    self._stored[topic.name].append(
                        Stored(received, stamp, size, self.part, number, 0, frame)
                    )
        except FAULTS as error:
            self.notes.append(f"{self.path}: cut off or damaged ({_said(error)}); it is read up to there")

    def _rows(self) -> Iterator[tuple[int, int, int, int]]:
        asked = "select id, topic_id, timestamp, length(data) from messages not indexed where typeof(data) = 'blob'"
        for row in self._base.execute(asked):
            if all(isinstance(value, int) for value in row):
                yield row

    def _head(self, number: int, size: int) -> tuple[int | None, str | None]:
        """Time and frame of a message's header."""
        with closing(self._blob(number)) as blob:
            start = blob.read(min(size, HEADER_BYTES))
        if is_zstd(start):
            return None, None
        return stamp_at_head(start), frame_at_head(start)

    def _blob(self, number: int) -> sqlite3.Blob:
        return self._base.blobopen("messages", "data", number, readonly=True)


def _opened(path: Path) -> sqlite3.Connection:
    """The database, which is never written to; a journal beside it, of a recorder that was killed, is taken in."""
    journal = path.with_name(path.name + "-wal")
    mode = "mode=ro" if journal.exists() and journal.stat().st_size else "mode=ro&immutable=1"
    try:
        base = sqlite3.connect(f"{path.absolute().as_uri()}?{mode}", uri=True, check_same_thread=False)
        base.execute("pragma trusted_schema = off")
        base.execute("pragma cell_size_check = on")
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_MESSAGE)
    except FAULTS as error:
        raise BagError(f"{path}: cannot be opened ({_said(error)}){_hint(error)}") from None
    return base


def _said(error: Exception) -> str:
    return "no memory for the length that a row says" if isinstance(error, MemoryError) else str(error)


def _hint(error: Exception) -> str:
    text = str(error)
    if isinstance(error, MemoryError) or "malformed" in text or "not a database" in text:
        return "; it is cut off or damaged: `sqlite3 FILE .recover` saves what is whole"
    return ""
