"""What reads input from outside, each as a function of bytes: it returns, or raises an error of this package."""

import asyncio
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.malformed import seeds

LEAST_LIMIT = 1 << 26
"""A limit below this counts as this: the interpreter takes memory of its own in larger pieces [bytes]."""
ANSWERS_S = 0.004
"""So long an answer to malformed bytes is awaited; one to a right request longer [s]."""


class Target(NamedTuple):
    """A reader.

    Args:
        name: in words.
        read: takes bytes, and a folder for files.
        seeds: inputs as they are meant.
        longest: of an input that is tried [bytes].
        limit: what the code says that it takes at most [bytes].
        words: that inputs may have.
    """

    name: str
    read: Callable[[bytes, Path], None]
    seeds: Callable[[], list[bytes]]
    longest: int
    limit: int
    words: Sequence[str] = ()


def read_mcap(data: bytes, folder: Path) -> None:
    """A file of MCAP, as a bag."""
    _read_bag(_file(folder / "a.mcap", data))


def read_sqlite(data: bytes, folder: Path) -> None:
    """A file of rosbag2's storage sqlite3, as a bag."""
    _read_bag(_file(folder / "a.db3", data))


def read_metadata(data: bytes, folder: Path) -> None:
    """What stands beside the files of a bag."""
    bag = folder / "bag"
    bag.mkdir(exist_ok=True)
    if not (bag / "a.mcap").exists():
        (bag / "a.mcap").write_bytes(seeds.mcap_seeds()[0])
    _file(bag / "metadata.yaml", data)
    _read_bag(bag)


def read_recording(data: bytes, folder: Path) -> None:
    """A run that was kept: looked through, its configuration, its passes."""
    from elbowroom.monitor.blackbox.recording import Recording

    with Recording(_file(folder / "run.mcap", data)) as recording:
        recording.wrong()
        for number in range(len(recording)):
            with suppress(ElbowroomError):
                recording.at(number)
        recording.configuration()


def read_depth(data: bytes, folder: Path) -> None:
    """A depth image, by its first bytes."""
    from elbowroom.sources.depth_image import check_depth_image, read_depth_image

    path = _file(folder / "a.png", data)
    check_depth_image(path, *seeds.SIZE)
    read_depth_image(path, *seeds.SIZE)


def read_mask(data: bytes, folder: Path) -> None:
    """The mask of a camera."""
    from elbowroom.files.mask_file import read_mask as read

    read(_file(folder / "mask.png", data), *seeds.SIZE)


def read_site(data: bytes, folder: Path) -> None:
    """A site file, with all that it says itself."""
    from elbowroom.site import Site

    site = Site.load(_file(folder / "site.yaml", data))
    for look in (site.grid, site.cameras, site.terms, site.margin):
        with suppress(ElbowroomError):
            look()


def read_joints(data: bytes, folder: Path) -> None:
    """Joints over time, as CSV."""
    from elbowroom.sensing import JointRecord

    record = JointRecord.from_csv(_file(folder / "joints.csv", data), 10**9)
    first, last = int(record.stamps_ns[0]), int(record.stamps_ns[-1])
    for at_ns in (first, (first + last) // 2, last):
        with suppress(ElbowroomError):
            record.at(at_ns)
        record.velocities_at(at_ns)


def read_joint_message(data: bytes, folder: Path) -> None:
    """A message of joints."""
    from elbowroom.sources.bags.messages import joint_state_of

    joint_state_of(data, "it")


class _Served:
    """A Modbus server of our own, and the loop that it runs in."""

    def __init__(self) -> None:
        import socket

        from elbowroom.guard.modbus import ModbusServer
        from elbowroom.guard.watch import Watched

        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.loop = asyncio.new_event_loop()
        watched = Watched(1)
        self.server = ModbusServer("127.0.0.1", self.port, 1, lambda: watched.said(0))
        self.loop.run_until_complete(self.server.begin())
        self.right = seeds.modbus_seeds()[2]
        self.due = self.loop.run_until_complete(self._answer(self.right, 2.0))
        if len(self.due) < 9 + 8:
            raise AssertionError(f"a right request is answered by {self.due!r}")

    def ask(self, data: bytes) -> None:
        """Sends what is malformed; a right request has to be answered as before."""
        self.loop.run_until_complete(self._answer(data, ANSWERS_S))
        found = self.loop.run_until_complete(self._answer(self.right, 2.0))
        if found != self.due:
            raise AssertionError(f"a right request is answered by {found!r}")

    async def _answer(self, data: bytes, waits_s: float) -> bytes:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        found = b""
        with suppress(OSError, asyncio.TimeoutError):
            writer.write(data)
            await writer.drain()
            found = await asyncio.wait_for(reader.read(4096), waits_s)
        writer.close()
        with suppress(OSError):
            await writer.wait_closed()
        return found


_served: list[_Served] = []


def read_modbus(data: bytes, folder: Path) -> None:
    """Bytes at the port of the Modbus server; it goes on answering what is right, and nothing changes."""
    if not _served:
        _served.append(_Served())
    _served[0].ask(data)


def _file(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def _read_bag(path: Path) -> None:
    """All that is read of a bag, as `site from-bag` and `monitor` do."""
    from elbowroom.sources.bags.bag import Bag
    from elbowroom.sources.bags.depth import depth_of, kind_of
    from elbowroom.sources.bags.joints import record_of, told_of
    from elbowroom.sources.bags.messages import COMPRESSED, IMAGE, JOINT_STATE
    from elbowroom.sources.bags.site_of import Wish, site_of

    with Bag(path) as bag:
        with suppress(ElbowroomError):
            site_of(bag, Wish())
        with suppress(ElbowroomError):
            told = told_of(bag, bag.of_type(JOINT_STATE))
            if told.positions:
                record_of(told, list(told.positions), 10**9)
        for topic in bag.of_type(IMAGE, COMPRESSED):
            for stored in bag.messages(topic) if bag.topics[topic].encoding == "cdr" else ():
                with suppress(ElbowroomError):
                    data = bag.read(stored)
                    kind = kind_of(bag.topics[topic].type, data, topic)
                    depth_of(bag.topics[topic].type, data, topic, kind.size)


def targets() -> list[Target]:
    """All of them, each with what its code says that it takes at most."""
    from elbowroom.files.yaml_file import MAX_YAML_BYTES
    from elbowroom.sources.bags.storage import LARGEST_MESSAGE
    from elbowroom.sources.depth_png import MAX_FILE_BYTES_PER_PIXEL
    from elbowroom.wire.depth_codec import MOST_PIXELS

    width, height = seeds.SIZE
    image = MAX_FILE_BYTES_PER_PIXEL * width * height
    topics = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "tf2_msgs/msg/TFMessage")
    words = (
        *topics,
        "16UC1",
        "32FC1",
        "compressedDepth",
        "rvl",
        "png",
        "zstd",
        "lz4",
        "32FC1; elbowroom",
        "cdr",
    )
    return [
        Target("mcap", read_mcap, seeds.mcap_seeds, 1 << 15, LARGEST_MESSAGE, words),
        Target("sqlite3", read_sqlite, seeds.sqlite_seeds, 1 << 16, LARGEST_MESSAGE, words),
        Target("metadata", read_metadata, seeds.metadata_seeds, 1 << 12, LARGEST_MESSAGE),
        Target("recording", read_recording, seeds.recording_seeds, 1 << 18, 4 * MOST_PIXELS),
        Target("depth image", read_depth, seeds.png_seeds, 1 << 12, image, ("IHDR", "IDAT", "IEND", "P5")),
        Target("mask", read_mask, seeds.mask_seeds, 1 << 11, image, ("IHDR", "IDAT", "IEND", "tRNS")),
        Target("site", read_site, seeds.yaml_seeds, 1 << 14, MAX_YAML_BYTES),
        Target("joints", read_joints, seeds.joint_seeds, 1 << 12, LEAST_LIMIT),
        Target("joint message", read_joint_message, seeds.joint_message_seeds, 1 << 12, LEAST_LIMIT),
        Target("modbus", read_modbus, seeds.modbus_seeds, 1 << 9, LEAST_LIMIT),
    ]


def target_of(name: str) -> Target:
    """A target by its name."""
    return next(target for target in targets() if target.name == name)


def dictionary(target: Target) -> bytes:
    """The words of a target as a dictionary of libFuzzer."""
    return b"".join(b'"' + word.encode() + b'"\n' for word in target.words)


def quietly(target: Target, data: bytes, folder: Path) -> None:
    """Reads; an error of this package is an answer.

    Args:
        target: that reads.
        data: what it is given.
        folder: for files.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with suppress(ElbowroomError):
            target.read(data, folder)
