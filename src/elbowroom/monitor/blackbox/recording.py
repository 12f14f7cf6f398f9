"""A recording, opened: its configuration, and its passes as they were."""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError, ElbowroomError
from elbowroom.monitor.blackbox.configuration import CONFIGURATION, SITE, Configuration
from elbowroom.monitor.blackbox.kept_pass import PASS, depth_topic
from elbowroom.monitor.blackbox.kept_values import made
from elbowroom.sensing import DepthFrame, MeantPath, Snapshot
from elbowroom.wire.cdr_reader import packed_image_of
from elbowroom.wire.chained_file import ChainedFile, Read
from elbowroom.wire.depth_codec import head_of, unpack_depth, unpack_units
from elbowroom.wire.ros_messages import text_of

LARGEST_RECORD = 1 << 24
"""No pass says more of itself, images apart [bytes]."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedPass:
    """A pass as it was.

    Args:
        number: of its step in the file, from 0.
        sequence: of the pass in its run.
        wall_ns: when it was, by the computer's calendar [ns].
        lost: how many passes before it were not kept.
        snapshot: what was given.
        judged: what came of it, as `kept_pass.judged` says it.
        gate: what the gate decided; None: there was none.
        margins: how far the machine was from what it may hit; None: nobody asked, or it was not kept.
    """

    number: int
    sequence: int
    wall_ns: int
    lost: int
    snapshot: Snapshot
    judged: Mapping[str, Any]
    gate: Mapping[str, Any] | None
    margins: Mapping[str, Any] | None = None


class Recording:
    """A file of `monitor --record`, or of the black box.

    Args:
        path: the file.

    Raises:
        BagError: it is none. One that is cut off before its first pass has none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = ChainedFile(path)
        self._frames: dict[str, tuple[int, DepthFrame, memoryview]] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def __len__(self) -> int:
        """How many passes it holds."""
        return len(self._file)

    @property
    def note(self) -> str | None:
        """That it is cut off, in a sentence; None: it is whole."""
        return self._file.note

    @property
    def ends(self) -> tuple[int, ...]:
        """Where each pass ends in the file [bytes]."""
        return self._file.ends

    @property
    def sum(self) -> str:
        """Of all of it."""
        return self._file.sum

    @property
    def size(self) -> int:
        """Of the file [bytes]."""
        return self._file.length

    def wrong(self, tell: Callable[[int], None] = lambda done: None) -> str | None:
        """What is not as it was written; None: nothing.

        Args:
            tell: told how many bytes have been looked at.
        """
        return self._file.wrong(tell)

    def configuration(self) -> Configuration:
        """By which passes were judged.

        Raises:
            BagError: it is cut off before that, or malformed.
        """
        content, text = self._file.attached(CONFIGURATION), self._file.attached(SITE)
        if content is None or text is None:
            raise BagError(self.note or f"{self.path}: holds no {CONFIGURATION}")
        return Configuration.read(content, text, str(self.path))

    def passes(self, begin: int = 0) -> Iterator[RecordedPass]:
        """The passes in their order.

        Args:
            begin: number of the first one.

        Raises:
            BagError, PackageError: as `at`.
        """
        return (self.at(number) for number in range(begin, len(self)))

    def number_of(self, sequence: int) -> int:
        """The number in this file of a pass of the run.

        Args:
            sequence: its number in the run.

        Raises:
            BagError: it is not there.
        """
        low, high = 0, len(self)
        while low < high:
            middle = (low + high) // 2
            if self._told(middle)[0]["sequence"] < sequence:
                low = middle + 1
            else:
                high = middle
        if low == len(self) or self._told(low)[0]["sequence"] != sequence:
            raise BagError(f"{self.path}: cycle {sequence} is not there; {self._span()}")
        return low

    def at(self, number: int) -> RecordedPass:
        """A pass.

        Args:
            number: in this file, from 0.

        Raises:
            BagError: malformed.
            PackageError: zstandard is not installed.
        """
        told, messages = self._told(number)
        what = f"{self.path}: pass {number}"
        try:
            given = told["given"]
            frames = tuple(self._frame(number, messages, *one) for one in given["frames"])
            snapshot = Snapshot(
                frames,
                None if given["joints"] is None else _positions(given["joints"]),
                {camera: _positions(joints) for camera, joints in given["joints_of"].items()},
                given["now_ns"],
                dict(given["clock_bounds_ns"]),
                given["joints_ns"],
                None if given["commanded"] is None else _positions(given["commanded"]),
                _positions(given["velocities"]),
                MeantPath(**given["path"]) if given.get("path") is not None else None,
            )
            numbers = int(told["sequence"]), int(told["wall_ns"]), int(told["lost"])
            return RecordedPass(number, *numbers, snapshot, told["judged"], told["gate"], told.get("margins"))
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
            if isinstance(error, ElbowroomError):
                raise BagError(f"{what}: {error}") from None
            raise BagError(f"{what}: malformed ({type(error).__name__}: {error})") from None

    def said_at(self, number: int) -> Mapping[str, Any]:
        """What a pass says of itself, without its images: `sequence`, `wall_ns`, `judged`, `gate`.

        Args:
            number: in this file, from 0.

        Raises:
            BagError: malformed.
        """
        return self._told(number)[0]

    def units_of(self, camera: str) -> tuple[NDArray[np.uint16], float] | None:
        """The last frame that was read of a camera as its sensor's whole numbers, and metres per unit.

        Args:
            camera: its name; a frame of it was read.

        Returns:
            None: it is not made of units, or they have a bias.
        """
        packed, what = self._frames[camera][2], f"{self.path}: {camera}"
        units = head_of(packed, what).units
        if units is None or units.bias_m:
            return None
        numbers = unpack_units(packed, what)
        return None if numbers is None else (numbers, float(f"{units.scale_m:.7g}"))

    def _span(self) -> str:
        if not len(self):
            return "it has no pass"
        first, last = self._told(0)[0]["sequence"], self._told(len(self) - 1)[0]["sequence"]
        return f"cycles are {first} to {last}"

    def _told(self, number: int) -> tuple[Mapping[str, Any], list[Read]]:
        """What a pass says of itself, and all messages of its step."""
        messages = self._file.step(number)
        for one in messages:
            if one.topic == PASS and len(one.data) <= LARGEST_RECORD:
                try:
                    told = json.loads(text_of(one.data))
                    if isinstance(told, dict) and isinstance(told["sequence"], int):
                        return told, messages
                except (ValueError, KeyError, RecursionError):
                    break
        raise BagError(f"{self.path}: pass {number}: malformed: it does not say what it is")

    def _frame(
        self, number: int, messages: list[Read], camera: str, wanted: int, stamp_ns: int | None
    ) -> DepthFrame:
        """A frame, from this step or the last before it that has it."""
        known = self._frames.get(camera)
        if known is not None and known[0] == wanted:
            return known[1]
        topic = depth_topic(camera)
        for step in range(number, -1, -1):
            found = messages if step == number else self._file.step(step)
            for one in found:
                if one.topic == topic and one.number == wanted:
                    what = f"{self.path}: image {wanted} of {camera}"
                    packed = packed_image_of(one.data, what)
                    frame = DepthFrame(camera, stamp_ns, unpack_depth(packed, what))
                    self._frames[camera] = wanted, frame, packed
                    return frame
        raise BagError(f"{self.path}: image {wanted} of {camera} is not there")


def _positions(given: Mapping[str, Any]) -> dict[str, float]:
    return {name: float(made(value)) for name, value in given.items()}
