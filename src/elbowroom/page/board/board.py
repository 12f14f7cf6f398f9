"""What the monitor tells the page: texts of every pass, planes ten times a second, images when they are asked for."""

import json
import mmap
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.page.board.section import Section, space_for
from elbowroom.page.scene.near import Planes
from elbowroom.sensing import DepthFrame, Snapshot

MOST_TEXT = 1 << 20
"""No pass says more [bytes]."""
SHARED = Path("/dev/shm")


@dataclass(frozen=True, slots=True)
class Sizes:
    """How much the sections hold.

    Args:
        text, planes, images: bytes of one slot each.
    """

    text: int
    planes: int
    images: int

    @classmethod
    def of(cls, grid: VoxelGrid, cameras: Sequence[DepthCamera]) -> Self:
        """For a room.

        Args:
            grid: the watched box.
            cameras: of the room.
        """
        words = bits.word_count(grid)
        pixels = sum(camera.width * camera.height for camera in cameras)
        return cls(MOST_TEXT, 64 + 3 * 8 * words + words, MOST_TEXT + 4 * pixels)

    @property
    def whole(self) -> int:
        """Of the file [bytes]."""
        return 64 + sum(space_for(size) for size in (self.text, self.planes, self.images))


class Board:
    """A file that both processes have mapped.

    The first 64 bytes are the page's: how often it asked for images. All else is the monitor's.

    Args:
        path: of the file; it is there.
        sizes: of its sections.
    """

    def __init__(self, path: Path, sizes: Sizes) -> None:
        self.path, self.sizes = path, sizes
        with path.open("r+b") as file:
            self._map = mmap.mmap(file.fileno(), sizes.whole)
        self._memory = memoryview(self._map)
        at, sections = 64, []
        for size in (sizes.text, sizes.planes, sizes.images):
            sections.append(Section(self._memory[at : at + space_for(size)], size))
            at += space_for(size)
        self.text, self.planes, self.images = sections

    @classmethod
    def made(cls, sizes: Sizes) -> Self:
        """A new one, in memory where the system has files there; only its owner can open it.

        Args:
            sizes: of its sections.
        """
        place = SHARED if SHARED.is_dir() and os.access(SHARED, os.W_OK) else None
        handle, name = tempfile.mkstemp(prefix="elbowroom-page-", dir=place)
        os.ftruncate(handle, sizes.whole)
        os.close(handle)
        return cls(Path(name), sizes)

    def forget(self) -> None:
        """Takes the file's name away; whoever has it open keeps it."""
        self.path.unlink(missing_ok=True)

    def said(self) -> dict[str, Any]:
        """What another process needs to open it."""
        return {"path": str(self.path), "sizes": asdict(self.sizes)}

    @classmethod
    def opened(cls, said: Mapping[str, Any]) -> Self:
        """The one that another process made.

        Args:
            said: of `said`.
        """
        return cls(Path(said["path"]), Sizes(**said["sizes"]))

    @property
    def asked(self) -> int:
        """How often images were asked for."""
        return int.from_bytes(self._memory[:8], "little")

    def ask(self) -> int:
        """Asks for images; the number of this question."""
        number = self.asked + 1
        self._memory[:8] = number.to_bytes(8, "little")
        return number

    def tell(self, told: Mapping[str, Any]) -> bool:
        """Writes a pass; whether it fitted."""
        return self.text.put([_bytes(told)])

    def show(self, sequence: int, planes: Planes) -> bool:
        """Writes planes; whether they fitted.

        Args:
            sequence: of the pass that they are of.
            planes: of its free space.
        """
        head = np.array([sequence, len(planes.free), planes.looked_at.size], dtype=np.uint64)
        parts = (head, planes.free, planes.surface, planes.blind, planes.looked_at.view(np.uint8))
        return self.planes.put([np.ascontiguousarray(part).view(np.uint8).data for part in parts])

    def answer(self, number: int, told: Mapping[str, Any], snapshot: Snapshot) -> bool:
        """Writes images that were asked for; whether they fitted.

        Args:
            number: of the question.
            told: of the pass that they belong to.
            snapshot: of that pass.
        """
        frames = snapshot.frames
        shapes = [[frame.camera, frame.stamp_ns, *frame.depth_m.shape] for frame in frames]
        joints_of = {name: dict(joints) for name, joints in snapshot.joints_of.items()}
        head = _bytes({"number": number, "told": told, "frames": shapes, "joints_of": joints_of})
        parts = [np.ascontiguousarray(frame.depth_m).view(np.uint8).data.cast("B") for frame in frames]
        return self.images.put([len(head).to_bytes(8, "little"), head, *parts])


def read_planes(content: bytes) -> tuple[int, Planes]:
    """Sequence and planes of what `Board.show` wrote.

    Args:
        content: its bytes.
    """
    sequence, words, looked = (int(n) for n in np.frombuffer(content, np.uint64, 3))
    planes = np.frombuffer(content, np.uint64, 3 * words, 24).reshape(3, words)
    looked_at = np.frombuffer(content, np.bool_, looked, 24 + 24 * words)
    return sequence, Planes(planes[0], planes[1], planes[2], looked_at)


class Answered(NamedTuple):
    """What `Board.answer` wrote.

    Args:
        number: of the question.
        told: of the pass.
        snapshot: its images, and where the machine was.
    """

    number: int
    told: dict[str, Any]
    snapshot: Snapshot


def read_images(content: bytes) -> Answered:
    """What `Board.answer` wrote.

    Args:
        content: its bytes.
    """
    length = int.from_bytes(content[:8], "little")
    head = json.loads(content[8 : 8 + length])
    at, frames = 8 + length, []
    for camera, stamp_ns, height, width in head["frames"]:
        depth: NDArray[np.float32] = np.frombuffer(content, np.uint8, 4 * height * width, at).view(np.float32)
        frames.append(DepthFrame(camera, stamp_ns, depth.reshape(height, width)))
        at += 4 * height * width
    told = head["told"]
    given = Snapshot(tuple(frames), told["joints"], head["joints_of"], told["now_ns"], told["bounds"])
    return Answered(head["number"], told, given)


def _bytes(told: Mapping[str, Any]) -> bytes:
    return json.dumps(told, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
