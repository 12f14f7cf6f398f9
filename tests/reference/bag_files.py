"""Bags that other people's writers write: rosbags for the folders of `ros2 bag record`, mcap for files alone."""

import io
import struct
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from PIL import Image as Picture
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
INFO, JOINTS, TF = "sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
STORAGES = {"sqlite3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}
MODES = {"file": CompressionMode.FILE, "message": CompressionMode.MESSAGE, "storage": CompressionMode.STORAGE}
T0 = 1_700_000_000_000_000_000
MS = 1_000_000


def made(kind, **fields):
    """A message of a type."""
    return STORE.types[kind](**fields)


def header(stamp_ns, frame=""):
    time = made("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return made("std_msgs/msg/Header", stamp=time, frame_id=frame)


def image(pixels, stamp_ns, frame="", *, encoding=None, big=False, padding=0):
    """An Image of 16UC1 or 32FC1 by the type of its pixels, with so many bytes of something after each row."""
    height, width = pixels.shape
    kind = "f4" if pixels.dtype.kind == "f" else "u2"
    rows = pixels.astype((">" if big else "<") + kind).view(np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=171)
    return made(
        IMAGE,
        header=header(stamp_ns, frame),
        height=height,
        width=width,
        encoding=encoding or {"f4": "32FC1", "u2": "16UC1"}[kind],
        is_bigendian=int(big),
        step=rows.shape[1],
        data=rows.ravel(),
    )


def png(numbers):
    out = io.BytesIO()
    Picture.fromarray(numbers).save(out, format="PNG")
    return out.getvalue()


def compressed(data, stamp_ns, frame="", form="16UC1; compressedDepth", quant=(0.0, 0.0)):
    """A CompressedImage of the transport compressedDepth: its twelve bytes, then what is given."""
    whole = struct.pack("<iff", 0, *quant) + data
    return made(COMPRESSED, header=header(stamp_ns, frame), format=form, data=np.frombuffer(whole, np.uint8))


def quantised(metres, depth_max=10.0, depth_quantization=100.0):
    """What image_transport_plugins' compressed_depth_image_transport makes of metres: numbers, A and B."""
    a = np.float32(depth_quantization * (depth_quantization + 1.0))
    b = np.float32(1.0 - a / depth_max)
    with np.errstate(divide="ignore", invalid="ignore"):
        numbers = np.where((metres > 0) & (metres < depth_max), a / metres + b, 0)
    return numbers.astype(np.uint16), (float(a), float(b))


def camera_info(camera, stamp_ns, frame="", **more):
    k = camera.intrinsics
    fields = {
        "header": header(stamp_ns, frame),
        "height": camera.height,
        "width": camera.width,
        "distortion_model": "plumb_bob",
        "d": np.zeros(5),
        "k": np.array([k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1.0]),
        "r": np.eye(3).ravel(),
        "p": np.array([k.fx, 0, k.cx, 0, 0, k.fy, k.cy, 0, 0, 0, 1.0, 0]),
        "binning_x": 0,
        "binning_y": 0,
        "roi": made(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        ),
    }
    return made(INFO, **{**fields, **more})


def region(x, y, width, height):
    return made(
        "sensor_msgs/msg/RegionOfInterest",
        x_offset=x,
        y_offset=y,
        height=height,
        width=width,
        do_rectify=False,
    )


def joint_state(positions, stamp_ns, names=None, velocities=()):
    return made(
        JOINTS,
        header=header(stamp_ns),
        name=list(positions) if names is None else names,
        position=np.array(list(positions.values()) if names is None else positions, dtype=np.float64),
        velocity=np.array(velocities, dtype=np.float64),
        effort=np.zeros(0),
    )


def transform(parent, child, pose, stamp_ns=T0):
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(np.asarray(pose)[:3, :3]).as_quat()
    return made(
        "geometry_msgs/msg/TransformStamped",
        header=header(stamp_ns, parent),
        child_frame_id=child,
        transform=made(
            "geometry_msgs/msg/Transform",
            translation=made(
                "geometry_msgs/msg/Vector3",
                **dict(zip("xyz", map(float, np.asarray(pose)[:3, 3]), strict=True)),
            ),
            rotation=made("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w),
        ),
    )


def transforms(*stamped):
    return made(TF, transforms=list(stamped))


def written(path, messages, storage="mcap", compressed_as=None):
    """A bag of (topic, received_ns, message) by rosbags; `compressed_as`: file, message or storage.

    Args:
        path: of the folder.
        messages: a message may be bytes with its type: (type, bytes).
    """
    writer = Writer(path, version=9, storage_plugin=STORAGES[storage])
    if compressed_as is not None:
        writer.set_compression(MODES[compressed_as], CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, received_ns, message in messages:
            kind = message[0] if isinstance(message, tuple) else message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            data = message[1] if isinstance(message, tuple) else STORE.serialize_cdr(message, kind)
            writer.write(connections[topic], received_ns, bytes(data))
    return Path(path)


def written_mcap(path, messages, compression=CompressionType.NONE, chunk_size=100_000, **more):
    """A bare MCAP file of the same, by the library of those who made the format."""
    with Path(path).open("wb") as file:
        writer = McapWriter(file, chunk_size=chunk_size, compression=compression, **more)
        writer.start(profile="ros2", library="test")
        channels = {}
        for topic, received_ns, message in messages:
            kind = message[0] if isinstance(message, tuple) else message.__msgtype__
            if topic not in channels:
                schema = writer.register_schema(kind, "ros2msg", b"")
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            data = message[1] if isinstance(message, tuple) else STORE.serialize_cdr(message, kind)
            writer.add_message(channels[topic], received_ns, bytes(data), received_ns)
        writer.finish()
    return Path(path)
