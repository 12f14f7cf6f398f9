"""What a bag says of a site: cameras with lenses and places, their topics, joints; and how large the room may be."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError
from elbowroom.geometry import DepthCamera
from elbowroom.sources.bags.axes import require_one_frame
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.camera_infos import info_topic, lens_by
from elbowroom.sources.bags.depth import METRES, OWN, OWN_RADIAL, depth_of
from elbowroom.sources.bags.depth_topics import DepthTopic, chosen
from elbowroom.sources.bags.frames import Frames, frames_of
from elbowroom.sources.bags.joints import told_of
from elbowroom.sources.bags.messages import JOINT_STATE

LONGEST_SIDE_M = 30.0
GLANCE = 40
"""Of an image so many rows and columns are looked at to guess the room's size."""
MILLIMETRE_M = 0.001


class Wish(NamedTuple):
    """What a user says of the site that a bag does not.

    Args:
        world: name of the world's frame; None: the one that all cameras stand in.
        depth: topics, each alone or as CAMERA=TOPIC; none: one of each camera.
        joints: topics of joints; none: all that there are.
    """

    world: str | None = None
    depth: Sequence[str] = ()
    joints: Sequence[str] = ()


class SiteOf(NamedTuple):
    """What a bag says of a site.

    Args:
        world: name of the world's frame.
        cameras: with their poses and lenses.
        topics: of each camera.
        said: of each camera, where its lens is from and what is odd about it.
        joints: topics of joints, and by topic the joints that have positions.
        bases: frames that may be a machine's base, and where they are in the world, shape (4, 4).
        box: least and greatest corner of a box around cameras and what they see at first [m].
        notes: what a user should know.
    """

    world: str
    cameras: Sequence[DepthCamera]
    topics: Mapping[str, DepthTopic]
    said: Mapping[str, Sequence[str]]
    joints: Mapping[str, Sequence[str]]
    bases: Mapping[str, NDArray[np.float64]]
    box: tuple[NDArray[np.float64], NDArray[np.float64]]
    notes: Sequence[str]


def site_of(bag: Bag, wish: Wish) -> SiteOf:
    """What a bag says of a site.

    Args:
        bag: opened.
        wish: what the user says.

    Raises:
        BagError: no depth, no CameraInfo, no chain of transforms, or one of these that cannot be read.
        FrameError: a topic with images of two frames.
        InputError: several topics of depth of a camera, or a wish that the bag cannot fulfil.
    """
    topics, frames = chosen(bag, wish.depth), frames_of(bag)
    for name, topic in topics.items():
        require_one_frame(f"{name} ({bag.path})", topic.name, topic.frames)
        if not topic.kind.frame:
            raise BagError(
                f"{bag.path}: {topic.name}: its header names no frame, so camera {name} has no place"
            )
    _require_own_frames(bag, topics)
    world = _world(bag, frames, topics, wish.world)
    cameras, said = [], {}
    for name, topic in topics.items():
        camera, told = _camera(bag, name, topic, frames, world)
        cameras.append(camera)
        said[name] = told
    joints = {topic: _joints(bag, topic) for topic in wish.joints or bag.of_type(JOINT_STATE)}
    box, notes = _box(bag, cameras, topics), (*bag.notes, *frames.notes)
    return SiteOf(world, cameras, topics, said, joints, _bases(frames, world), box, notes)


def _require_own_frames(bag: Bag, topics: Mapping[str, DepthTopic]) -> None:
    """Refuses two cameras in one frame: they would see the same from the same place."""
    first: dict[str, str] = {}
    for name, topic in topics.items():
        frame = topic.kind.frame.removeprefix("/")
        if frame in first:
            raise BagError(
                f"{bag.path}: images of cameras {first[frame]} and {name} say the same frame, {frame}: each camera has "
                "one of its own; correct its driver's frame_id, or choose one topic of a camera with --depth"
            )
        first[frame] = name


def _bases(frames: Frames, world: str) -> dict[str, NDArray[np.float64]]:
    """Frames whose names say that they are a base, as far as they are known in the world."""
    found = {}
    for name in sorted({*frames.links, *(link.parent for link in frames.links.values())}):
        if "base" in name.lower():
            with suppress(BagError):
                found[name] = frames.world_from(name, world)
    return found


def _world(bag: Bag, frames: Frames, topics: Mapping[str, DepthTopic], wished: str | None) -> str:
    of_cameras = [topic.kind.frame.removeprefix("/") for topic in topics.values()]
    if wished is not None:
        for frame in of_cameras:
            frames.world_from(frame, wished)
        return wished
    found = frames.root_of(of_cameras)
    if found is None:
        ends = {frame: frames.chain(frame)[-1] for frame in of_cameras}
        # says why the first two do not meet
        frames.world_from(of_cameras[0], next(end for end in ends.values() if end != ends[of_cameras[0]]))
    assert found is not None
    if len(of_cameras) == 1 and found == of_cameras[0]:
        raise BagError(
            f"{bag.path}: tf: nothing says where {found} is (topic /tf_static); record it too, or --world {found} to "
            "measure from the camera itself"
        )
    return found


def _camera(
    bag: Bag, name: str, topic: DepthTopic, frames: Frames, world: str
) -> tuple[DepthCamera, list[str]]:
    """A camera, and what is to be said of it."""
    source, lens = info_topic(bag, topic), lens_by(bag, topic.name)
    frame = topic.kind.frame.removeprefix("/")
    camera = DepthCamera(
        name=name,
        width=topic.kind.size[0],
        height=topic.kind.size[1],
        world_from_camera=frames.world_from(frame, world),
        intrinsics=lens.intrinsics,
    )
    told = [f"{topic.name}: {topic.text}", f"lens by {source}", *lens.notes]
    if topic.is_aligned:
        told.append(
            "depth brought to the pixels of a colour camera: edges are doubtful; raw depth is better, if it is there"
        )
    if "optical" not in frame:
        told.append(
            f"{frame} is taken for optical axes (z forward), though its name does not say so: look at the picture"
        )
    if topic.kind.packing == OWN_RADIAL:
        raise BagError(
            f"{bag.path}: {topic.name}: depth from the camera's centre, which no CameraInfo says; take the site "
            "file of that run (elbowroom export writes it)"
        )
    if topic.kind.encoding == METRES and topic.kind.packing not in ("", OWN):
        told.append("metres were quantised on the way; the nearest depth that fits is read")
    return camera, told


def _joints(bag: Bag, topic: str) -> list[str]:
    return sorted(told_of(bag, [topic]).positions)


def _box(
    bag: Bag, cameras: Sequence[DepthCamera], topics: Mapping[str, DepthTopic]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Around all cameras and most of what they see in their first images, to whole decimetres."""
    places = np.stack([camera.world_from_camera[:3, 3] for camera in cameras])
    seen = [_points(bag, camera, topics[camera.name]) for camera in cameras]
    points = np.concatenate([point for point in seen if len(point)] or [places])
    low = np.minimum(np.percentile(points, 2, axis=0), places.min(axis=0))
    high = np.maximum(np.percentile(points, 98, axis=0), places.max(axis=0))
    middle, half = (low + high) / 2, np.clip((high - low) / 2, 0.5, LONGEST_SIDE_M / 2)
    return np.floor((middle - half) * 10) / 10, np.ceil((middle + half) * 10) / 10


def _points(bag: Bag, camera: DepthCamera, topic: DepthTopic) -> NDArray[np.float64]:
    """Some of what a camera sees in its first image that is whole, shape (n, 3) [m, world]; distortion is left out."""
    size = topic.kind.size
    for stored in bag.messages(topic.name)[:3]:
        try:
            pixels = depth_of(bag.topics[topic.name].type, bag.read(stored), topic.name, size)
        except (BagError, ValueError):
            continue
        step_v, step_u = (max(1, side // GLANCE) for side in pixels.shape)
        some = pixels[::step_v, ::step_u].astype(np.float64)
        z = some * MILLIMETRE_M if pixels.dtype == np.uint16 else some
        x, y = camera.intrinsics.normalised(*size)
        with np.errstate(invalid="ignore"):
            there = np.isfinite(z) & (z > 0) & (z < LONGEST_SIDE_M)
        in_camera = np.stack([x[None, ::step_u] * z, y[::step_v, None] * z, z, np.ones_like(z)], axis=-1)[
            there
        ]
        return (in_camera @ camera.world_from_camera.T)[:, :3]
    return np.zeros((0, 3))
