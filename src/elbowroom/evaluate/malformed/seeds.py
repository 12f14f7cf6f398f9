"""Inputs as they are meant, made with the writers of this package: what is malformed is made of them."""

import io
import sqlite3
import struct
import tempfile
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path

import numpy as np

from elbowroom.extras import package
from elbowroom.wire import mcap_records as records
from elbowroom.wire import ros_schemas
from elbowroom.wire.cdr_writer import CdrWriter
from elbowroom.wire.depth_codec import Units, packed_pieces
from elbowroom.wire.mcap_writer import Attached, McapWriter, Told
from elbowroom.wire.ros_messages import (
    Lens,
    Placed,
    camera_info_message,
    depth_message,
    joint_state_message,
    text_message,
    transforms_message,
)

SIZE = 16, 12
"""Width and height of images [px]."""
T0_NS, STEP_NS, MOMENTS = 1_700_000_000_000_000_000, 66_000_000, 2
IMAGE = "sensor_msgs/msg/Image"


def numbers() -> np.ndarray:
    """An image in millimetres, shape (height, width), uint16: a slope, noise, and pixels without a return."""
    chance, (width, height) = np.random.default_rng(1), SIZE
    slope = 1000 + 7 * np.add.outer(np.arange(height), np.arange(width))
    found = (slope + chance.integers(-9, 9, slope.shape)).astype(np.uint16)
    found[chance.random(found.shape) < 0.1] = 0
    return found


def png_seeds() -> list[bytes]:
    """PNG and PGM of 16 bits."""
    from PIL import Image

    out, (width, height) = io.BytesIO(), SIZE
    Image.fromarray(numbers()).save(out, format="PNG")
    return [out.getvalue(), f"P5\n{width} {height}\n65535\n".encode() + numbers().astype(">u2").tobytes()]


def mask_seeds() -> list[bytes]:
    """The mask of a camera, as it is written."""
    from elbowroom.files.mask_file import write_mask

    with tempfile.TemporaryDirectory() as folder:
        return [write_mask(Path(folder) / "mask.png", numbers() == 0).read_bytes()]


def told() -> list[list[Told]]:
    """Messages of a few moments of two cameras and a machine."""
    moments = []
    for number in range(MOMENTS):
        at_ns = T0_NS + number * STEP_NS
        moments.append(
            [
                Told("/a/depth/image", IMAGE, _image(at_ns, "a_optical"), number),
                Told("/a/depth/camera_info", ros_schemas.CAMERA_INFO, _info(at_ns, "a"), number),
                Told("/b/depth/compressedDepth", ros_schemas.COMPRESSED_IMAGE, _png(at_ns), number),
                Told("/b/depth/camera_info", ros_schemas.CAMERA_INFO, _info(at_ns, "b"), number),
                Told("/c/depth/image", ros_schemas.COMPRESSED_IMAGE, _own(at_ns, number), number),
                Told("/c/depth/camera_info", ros_schemas.CAMERA_INFO, _info(at_ns, "c"), number),
                Told(
                    "/joint_states", ros_schemas.JOINT_STATE, joint_state_message(at_ns, {"j": 0.1}), number
                ),
                Told("/elbowroom/pass", ros_schemas.STRING, text_message("{}"), number),
            ]
        )
    placed = [Placed("world", f"{name}_optical", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0, 0.0)) for name in "abc"]
    moments[0].append(Told("/tf_static", ros_schemas.TF, transforms_message(T0_NS, placed)))
    return moments


def mcap_seeds() -> list[bytes]:
    """A file of our own, and one whose chunk is compressed."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        writer = McapWriter(path, [Attached("site.yaml", "application/yaml", b"name: a\n")])
        for number, messages in enumerate(told()):
            known = [one._replace(type=_known(one.type)) for one in messages]
            writer.step(known, T0_NS + number * STEP_NS)
        writer.end()
        return [path.read_bytes(), _compressed_mcap(told())]


def sqlite_seeds() -> list[bytes]:
    """A database as rosbag2 has it."""
    base = sqlite3.connect(":memory:")
    base.execute(
        "create table topics(id integer primary key, name text not null, type text not null, "
        "serialization_format text not null, offered_qos_profiles text not null)"
    )
    base.execute(
        "create table messages(id integer primary key, topic_id integer not null, timestamp integer not null, "
        "data blob not null)"
    )
    topics: dict[str, int] = {}
    for number, messages in enumerate(told()):
        for one in messages:
            if one.topic not in topics:
                topics[one.topic] = len(topics) + 1
                base.execute(
                    "insert into topics values (?, ?, ?, 'cdr', '')", (topics[one.topic], one.topic, one.type)
                )
            row = topics[one.topic], T0_NS + number * STEP_NS, one.data
            base.execute("insert into messages(topic_id, timestamp, data) values (?, ?, ?)", row)
    base.commit()
    return [base.serialize()]


@cache
def recording_seeds() -> list[bytes]:
    """A run that was kept: a pass of the simulated room with few small cameras."""
    from elbowroom.evaluate.recording.sample import record_sample

    with tempfile.TemporaryDirectory() as folder:
        return [record_sample(Path(folder) / "run.mcap", 2).read_bytes()]


def yaml_seeds() -> list[bytes]:
    """The site files of this package."""
    there = resources.files("elbowroom.site")
    return [
        (there / name).read_bytes() for name in ("new_site.yaml", "simulated_room.yaml", "thesis_room.yaml")
    ]


def metadata_seeds() -> list[bytes]:
    """What rosbag2 writes beside its files."""
    return [
        b"rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration: {nanoseconds: 1}\n"
        b"  starting_time: {nanoseconds_since_epoch: 1}\n  message_count: 2\n  topics_with_message_count: []\n"
        b"  compression_format: ''\n  compression_mode: ''\n  relative_file_paths: [a.mcap]\n"
        b"  files: [{path: a.mcap, message_count: 2}]\n"
    ]


def joint_seeds() -> list[bytes]:
    """Joints over time as CSV, with velocities, in several units of time."""
    rows = "".join(f"{T0_NS + n * STEP_NS},{0.1 * n},{0.2},{0.0}\n" for n in range(4))
    return [
        f"stamp_ns,slide,slide_velocity,turn\n{rows}".encode(),
        b"stamp_s,slide\n1.5,0.1\n1.6,0.2\n",
        b"\xef\xbb\xbfslide,stamp_ms\n0.1,3\n",
    ]


def joint_message_seeds() -> list[bytes]:
    """A message of joints, with velocities."""
    body = CdrWriter().header(T0_NS, "").texts(("slide", "turn")).reals((0.1, 0.2)).reals((0.0, 1.0))
    return [body.reals(()).done(), joint_state_message(T0_NS, {"slide": 0.25})]


def modbus_seeds() -> list[bytes]:
    """Requests of Modbus TCP: those that are answered, and those that are refused."""

    def framed(body: bytes) -> bytes:
        return struct.pack(">HHHB", 7, 0, len(body) + 1, 0) + body

    reads = [framed(struct.pack(">BHH", function, 0, 4)) for function in (1, 2, 3, 4)]
    writes = [framed(struct.pack(">BHH", function, 0, 1)) for function in (5, 6)]
    many = framed(struct.pack(">BHHB", 16, 0, 1, 2) + b"\x00\x01")
    return [*reads, *writes, many, framed(b"\x2b\x0e\x01\x00"), framed(b"\x07"), reads[2] + reads[3]]


def _known(kind: str) -> str:
    """A type that the writer has a definition of: it only names what is in the file."""
    return kind if kind in ros_schemas.SCHEMAS else ros_schemas.STRING


def _image(at_ns: int, frame: str) -> bytes:
    width, height = SIZE
    head = CdrWriter().header(at_ns, frame).whole(height).whole(width).text("16UC1").octet(0).whole(2 * width)
    return head.done_with([numbers().tobytes()])


def _png(at_ns: int) -> bytes:
    head = CdrWriter().header(at_ns, "b_optical").text("16UC1; compressedDepth png")
    return head.done_with([struct.pack("<iff", 0, 0.0, 0.0), png_seeds()[0]])


def _own(at_ns: int, number: int) -> bytes:
    depth_m = numbers().astype(np.float32) * np.float32(0.001)
    return depth_message(at_ns, "c", packed_pieces(depth_m, Units(0.001) if number else None))


def _info(at_ns: int, camera: str) -> bytes:
    return camera_info_message(at_ns, camera, Lens(SIZE, (14.0, 14.0, 7.5, 5.5), ()))


def _compressed_mcap(moments: Sequence[Sequence[Told]]) -> bytes:
    zstd = package("zstandard").ZstdCompressor()
    content, channels = b"", dict[str, int]()
    for number, messages in enumerate(moments):
        for one in messages:
            if one.topic not in channels:
                channels[one.topic] = index = len(channels) + 1
                content += records.schema(index, one.type, b"") + records.channel(index, index, one.topic)
            at_ns = T0_NS + number * STEP_NS
            content += records.message_head(records.Message(channels[one.topic], number, at_ns, one.data))
            content += one.data
    packed = zstd.compress(content)
    head = struct.pack("<QQQI", T0_NS, T0_NS + STEP_NS, len(content), 0)
    chunk = records.record(records.CHUNK, head, records.text("zstd"), struct.pack("<Q", len(packed)), packed)
    return records.MAGIC + records.header("elbowroom") + chunk + records.record(records.DATA_END, b"\0" * 4)
