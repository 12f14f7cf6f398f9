"""A look at what cameras say of each other: at first all of all, then every few passes one camera, in turn."""

from collections.abc import Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.findings import beyond_limit, contradictions
from elbowroom.reconstruct.contradiction.pairs import NOTHING, Pairs, points_of, seen_by, together
from elbowroom.reconstruct.contradiction.sample import Sample, sample_of
from elbowroom.sensing import DepthFrame, Snapshot

FIRST = 3
"""At so many moments at most all images are compared with all: until each camera had one."""
TURN = 200
"""Then in so many passes each camera is asked once,"""
PARTNERS = 8
"""about what so many others measured,"""
SAMPLES = 64
"""so many points each."""


class ContradictionLook:
    """Cameras that see through what others measure (`Look`).

    What is found at the first moments is said to the end: poses and lenses do not change. What is found later, in
    counts of one turn of all cameras, is said until the next turn is over.

    Args:
        cameras: of the room.
        margin: of cameras without one of their own.
    """

    name = "contradictions"

    def __init__(self, cameras: Sequence[DepthCamera], margin: Margin) -> None:
        self._cameras, self._margin = tuple(cameras), margin
        self._eyes = tuple(Eye.of(camera, margin) for camera in cameras)
        self._first: tuple[Finding, ...] = ()
        self._later: tuple[Finding, ...] = ()
        self._looked, self._passes, self._turns = 0, 0, 0
        self._pairs = Pairs.none(len(self._eyes))
        self._every = max(1, TURN // max(len(self._eyes), 1))

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """What is found by now."""
        frames = {frame.camera: frame for frame in snapshot.frames}
        if self._looked < FIRST and not self._first:
            self._first = contradictions(self._cameras, snapshot.frames, self._margin)
            self._looked = FIRST if len(frames) == len(self._cameras) else self._looked + 1
        elif self._passes % self._every == 0:
            self._ask_one(frames)
        self._passes += 1
        told = {name for finding in self._first for name in finding.about}
        return (*self._first, *(finding for finding in self._later if told.isdisjoint(finding.about)))

    def _ask_one(self, frames: dict[str, DepthFrame]) -> None:
        """Asks the next camera; after the last the turn is judged."""
        count = len(self._eyes)
        looker = self._passes // self._every % count
        partners = [(looker + 1 + self._turns * PARTNERS + n) % count for n in range(min(PARTNERS, count))]
        frame = frames.get(self._eyes[looker].name)
        points = [
            points_of(self._eyes[n], sample_of(self._eyes[n], own.depth_m, own.stamp_ns, SAMPLES), n)
            for n in dict.fromkeys(partners)
            if n != looker and (own := frames.get(self._eyes[n].name)) is not None
        ]
        if frame is None or not points:
            self._pairs.put(looker, NOTHING)
        else:
            image = Sample.none(frame.depth_m, frame.stamp_ns)
            self._pairs.put(looker, seen_by(self._eyes[looker], image, together(points), count))
        if looker == count - 1:
            self._turns += 1
            self._later = beyond_limit(self._eyes, self._pairs)
