"""Coordinate frames of a bag (REP 105): which stand still in which, and a chain of them as one transform."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.messages import TF, Transform, transforms_of

Array = NDArray[np.float64]
STATIC = "tf_static"
OFF_UNIT = 1e-3
"""A rotation's quaternion may be so much longer or shorter than 1."""
SAME_M, SAME = 1e-4, 1e-4
"""A frame that is said again within this stands still [m, and of a rotation matrix]."""
USUAL_WORLDS = ("world", "map")


class Link(NamedTuple):
    """Where a frame is.

    Args:
        parent: in which other frame.
        parent_from_child: shape (4, 4).
    """

    parent: str
    parent_from_child: Array


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of a bag that stand still.

    Args:
        name: of the bag, for errors.
        links: by frame.
        moving: frames that move, and in which frame.
        notes: what was odd.
    """

    name: str
    links: Mapping[str, Link]
    moving: Mapping[str, str] = field(default_factory=dict)
    notes: Sequence[str] = ()

    def chain(self, frame: str) -> list[str]:
        """A frame, that in which it stands, and so on to the last.

        Raises:
            BagError: a frame that stands in itself.
        """
        found = [frame]
        while (link := self.links.get(found[-1])) is not None:
            if link.parent in found:
                raise BagError(f"{self.name}: tf: frames in a circle: {' in '.join([*found, link.parent])}")
            found.append(link.parent)
        return found

    def world_from(self, frame: str, world: str) -> Array:
        """Where a frame is in the world, shape (4, 4).

        Args:
            frame: such as a camera's.
            world: name of the world's frame.

        Raises:
            BagError: no chain of frames that stand still leads from one to the other.
        """
        chain, other = self.chain(frame), self.chain(world)
        common = next((name for name in chain if name in other), None)
        if common is None:
            raise BagError(self._why_not(frame, world, chain, other))
        return np.linalg.inv(self._along(other, common)) @ self._along(chain, common)

    def root_of(self, frames: Sequence[str]) -> str | None:
        """The frame that all of these stand in: world or map if there are several, else the last; None: none."""
        chains = [self.chain(frame) for frame in frames]
        common = [name for name in chains[0] if all(name in chain for chain in chains)] if chains else []
        usual = [name for name in USUAL_WORLDS if name in common]
        return next(iter(usual or common[-1:]), None)

    def _along(self, chain: Sequence[str], end: str) -> Array:
        """end_from_first of a chain."""
        pose = np.eye(4)
        for name in chain[: list(chain).index(end)]:
            pose = self.links[name].parent_from_child @ pose
        return pose

    def _why_not(self, frame: str, world: str, chain: Sequence[str], other: Sequence[str]) -> str:
        told = f"{self.name}: tf: no chain of static transforms leads from {frame} to {world}"
        moved = [name for name in (*chain, *other) if name in self.moving]
        if moved:
            return f"{told}: {moved[0]} moves in {self.moving[moved[0]]}, and cameras must stand still"
        known = sorted({*self.links, *(link.parent for link in self.links.values())})
        if not known:
            return (
                f"{told}: there are none (topic /tf_static); record it too, or write poses into the site file"
            )
        ends = f"{frame} is known up to {chain[-1]}" if frame in known else f"{frame} is in none"
        return f"{told}: {ends}; frames are {', '.join(known)}"


def frames_of(bag: Bag) -> Frames:
    """The frames of a bag: those of /tf_static, and those of /tf that say the same throughout.

    Raises:
        BagError: a malformed message, or a rotation that is none.
    """
    links: dict[str, Link] = {}
    notes: list[str] = []
    for child, link in _said(bag, True):
        if child in links and not _same(links[child], link):
            notes.append(f"tf: {child} is said to be at two places by /tf_static; the last is taken")
        links[child] = link
    steady: dict[str, Link] = {}
    moving: dict[str, str] = {}
    for child, link in _said(bag, False):
        if child in links or child in moving:
            continue
        if not _same(steady.setdefault(child, link), link):
            moving[child] = link.parent
            del steady[child]
    if steady:
        names = ", ".join(sorted(steady)[:6]) + (", ..." if len(steady) > 6 else "")
        notes.append(
            f"tf: said by /tf, not /tf_static, and the same throughout, so taken to stand still: {names}"
        )
    return Frames(str(bag.path), {**steady, **links}, moving, tuple(dict.fromkeys(notes)))


def _said(bag: Bag, static: bool) -> Iterator[tuple[str, Link]]:
    for topic in bag.of_type(TF):
        if topic.endswith(STATIC) is static:
            for stored in bag.messages(topic):
                for transform in transforms_of(bag.read(stored), f"{bag.path}: {topic}"):
                    yield _name(transform.child), _link(transform, f"{bag.path}: {topic}")


def _link(transform: Transform, what: str) -> Link:
    turn, child = transform.rotation, transform.child
    length = float(np.linalg.norm(turn))
    if not (np.isfinite(turn).all() and np.isfinite(transform.translation).all()):
        raise BagError(f"{what}: {child} is at a place that is not finite")
    if abs(length - 1) > OFF_UNIT:
        raise BagError(f"{what}: the quaternion of {child} has length {length:.4g}, a rotation's is 1")
    pose = np.eye(4)
    pose[:3, :3] = _matrix(turn / length)
    pose[:3, 3] = transform.translation
    return Link(_name(transform.header.frame), pose)


def _matrix(xyzw: Array) -> Array:
    """Of a unit quaternion."""
    x, y, z, w = xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _name(frame: str) -> str:
    """Without the slash with which tf of ROS 1 began names."""
    return frame.removeprefix("/")


def _same(one: Link, other: Link) -> bool:
    a, b = one.parent_from_child, other.parent_from_child
    near = np.abs(a[:3, 3] - b[:3, 3]).max() <= SAME_M and np.abs(a[:3, :3] - b[:3, :3]).max() <= SAME
    return one.parent == other.parent and bool(near)
