"""Which cameras a bag has: topics of depth images, and a name for the camera of each."""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from elbowroom.errors import BagError, FrameError, InputError
from elbowroom.sources.bags.axes import frames_named
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.depth import TRANSPORT, Kind, kind_of
from elbowroom.sources.bags.lenses import RECTIFIED
from elbowroom.sources.bags.messages import COMPRESSED, IMAGE
from elbowroom.sources.bags.stamps import stamped
from elbowroom.sources.times.series import usual_step_ns
from elbowroom.sources.times.stamp import hz

ABOUT_DEPTH = re.compile(r"depth|image|stereo|ir|infra|color|colour|rgb|aligned|points?", re.IGNORECASE)
"""Words of a topic that say what is in it, and not of which camera."""
TRIED = 3
"""So many messages of a topic are looked at."""
ALIGNED = re.compile(r"aligned_depth|depth_registered|depth_to_(color|rgb)", re.IGNORECASE)


class DepthTopic(NamedTuple):
    """A topic of depth images.

    Args:
        name: of the topic.
        camera: whose they are, by the words of the topic.
        kind: of its first image.
        images: how many.
        step_ns: its usual step [ns]; None: there are no two.
        frames: that its images name.
    """

    name: str
    camera: str
    kind: Kind
    images: int
    step_ns: float | None
    frames: tuple[str, ...] = ()

    @property
    def is_aligned(self) -> bool:
        """Whether depth was brought to the pixels of a colour camera."""
        return ALIGNED.search(self.name) is not None

    @property
    def is_rectified(self) -> bool:
        """Whether images were made pinhole, by the topic's name."""
        return self.base.rpartition("/")[2].startswith(RECTIFIED)

    @property
    def base(self) -> str:
        """The topic without its transport."""
        return self.name.removesuffix(f"/{TRANSPORT}")

    @property
    def text(self) -> str:
        """What there is, in a line."""
        rate = "" if self.step_ns is None else f", {hz(max(self.step_ns, 1.0))}"
        axes = " and ".join(self.frames) or self.kind.frame or "no frame"
        return f"{self.kind.text}, {self.images} images{rate}, axes of {axes}"


class Found(NamedTuple):
    """What was found among the topics of images.

    Args:
        depth: topics of depth, by name.
        others: why each of the others is none.
    """

    depth: Mapping[str, DepthTopic]
    others: Mapping[str, str]


def depth_topics(bag: Bag) -> Found:
    """All topics that have depth images, by their first message that is whole.

    Raises:
        BagError: a bag that cannot be read.
    """
    found: dict[str, DepthTopic] = {}
    others: dict[str, str] = {}
    for topic in bag.of_type(IMAGE, COMPRESSED):
        kind = first_kind(bag, topic)
        if isinstance(kind, str):
            others[topic] = kind
            continue
        times = stamped(bag, topic).messages
        stamps = np.array([message.stamp_ns for message in times], dtype=np.int64)
        frames = frames_named(bag, (message.stored for message in times))
        found[topic] = DepthTopic(topic, camera_name(topic), kind, len(times), usual_step_ns(stamps), frames)
    return Found(found, others)


def chosen(bag: Bag, given: Sequence[str]) -> dict[str, DepthTopic]:
    """The depth topic of each camera, by the camera's name.

    Args:
        bag: opened.
        given: topics to take, each alone or as CAMERA=TOPIC; none: one of each camera that the bag has.

    Raises:
        BagError: there is none.
        InputError: one that is not there, or a camera with several of which none was given.
    """
    there = depth_topics(bag)
    if given:
        return _given(bag, there, given)
    if not there.depth:
        raise BagError(f"{bag.path}: no topic of depth images; {_others(bag, there)}")
    groups: dict[str, list[DepthTopic]] = defaultdict(list)
    for topic in _one_transport(there.depth):
        groups[topic.camera].append(topic)
    for camera, topics in groups.items():
        if len(topics) > 1:
            told = "; ".join(f"{t.name} ({t.text}{', aligned to colour' * t.is_aligned})" for t in topics)
            raise InputError(
                f"{bag.path}: camera {camera} has {len(topics)} topics of depth: {told}. Say which: --depth "
                f"{camera}={topics[0].name}, and likewise of each other camera"
            )
    return {camera: topics[0] for camera, topics in groups.items()}


def camera_name(topic: str) -> str:
    """A camera's name by its topic: its words up to those that say what is in it, joined; doubled ones once."""
    words = [word for word in topic.split("/") if word]
    own: list[str] = []
    for word in words:
        if any(ABOUT_DEPTH.fullmatch(part) for part in re.split(r"[_\W]+", word)) and (own or len(words) > 1):
            break
        if word not in own:
            own.append(word)
    return "_".join(own) or "_".join(words[:1]) or "camera"


def _given(bag: Bag, there: Found, given: Sequence[str]) -> dict[str, DepthTopic]:
    taken: dict[str, DepthTopic] = {}
    for text in given:
        camera, _, name = text.rpartition("=")
        topic = there.depth.get(name)
        if topic is None:
            why = f" ({there.others[name]})" if name in there.others else ""
            known = ", ".join(there.depth) or "no topic"
            raise InputError(
                f"depth: {bag.path} has no depth images on {name!r}{why}; it has them on {known}"
            )
        camera = camera or topic.camera
        if camera in taken:
            raise InputError(
                f"depth: two topics of camera {camera}: {taken[camera].name} and {name}; name one otherwise, "
                f"--depth NAME={name}"
            )
        taken[camera] = topic
    return taken


def _others(bag: Bag, found: Found) -> str:
    """What there is instead."""
    if found.others:
        return "; ".join(found.others.values())
    return f"topics are {', '.join(f'{t.name} ({t.type})' for t in bag.topics.values()) or 'none'}"


def _one_transport(topics: Mapping[str, DepthTopic]) -> list[DepthTopic]:
    """Of the same images sent twice, raw and compressed, the raw ones."""
    return [topic for name, topic in topics.items() if topic.base == name or topic.base not in topics]


def first_kind(bag: Bag, topic: str) -> Kind | str:
    """Of the first message of a topic of images that is a depth image; or why the first is none."""
    if bag.topics[topic].encoding != "cdr":
        return f"{topic}: written as {bag.topics[topic].encoding!r}, not cdr"
    why: str | None = None
    for stored in bag.messages(topic)[:TRIED]:
        try:
            return kind_of(bag.topics[topic].type, bag.read(stored), f"{bag.path}: {topic}")
        except (FrameError, BagError) as error:
            why = why or str(error)
    return why or f"{topic}: no message"
