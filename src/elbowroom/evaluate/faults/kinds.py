"""Every kind of fault, of every kind of input, and which causes name it rightly."""

import math
import random as standard
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.evaluate.faults.live import Image, Live, OfImages, OfPlace, OfSnapshots, Whole, Wrong
from elbowroom.evaluate.faults.scene import PLACES
from elbowroom.sensing import DepthFrame, Snapshot

Depth = NDArray[np.float32]
GAPS = ("camera_gaps", "camera_disconnected")
LATE = (*GAPS, "camera_too_old")
PUSHED_M = 0.06


@dataclass(frozen=True, slots=True)
class Kind:
    """A fault that can be thrown.

    Args:
        name: of the fault, in words.
        input: what it is thrown at: camera, joints, clock, process.
        causes: reasons of the gate that name it rightly.
        make: from the camera that it is thrown at and a source of chance; None: it is done from outside.
        restarts: the monitor has to be started again after it.
        most_s: it may take so long to be noticed [s]; what takes longer passes silently.
    """

    name: str
    input: str
    causes: tuple[str, ...]
    make: Callable[[str, standard.Random], Wrong] | None = None
    restarts: bool = False
    most_s: float = 3.0


def _images(change: Callable[[], Image]) -> Callable[[str, standard.Random], Wrong]:
    return lambda camera, chance: OfImages(camera, change())


def _depth(change: Callable[[Depth], NDArray[Any]]) -> Callable[[str, standard.Random], Wrong]:
    """A fault that makes other numbers of each image."""
    return _images(
        lambda: lambda frame, live: replace(frame, depth_m=np.asarray(change(frame.depth_m), np.float32))
    )


def _whole(change: Callable[[], Whole]) -> Callable[[str, standard.Random], Wrong]:
    return lambda camera, chance: OfSnapshots(change())


def _stuck() -> Image:
    """The image before, with new stamps."""
    kept: list[Depth] = []

    def change(frame: DepthFrame, live: Live) -> DepthFrame:
        kept.append(live.newest[frame.camera].depth_m if not kept else kept[0])
        return replace(frame, depth_m=kept[0].copy())

    return change


def _stuck_whole() -> Image:
    """The frame before, given anew with its stamp."""
    return lambda frame, live: replace(
        live.newest[frame.camera], depth_m=live.newest[frame.camera].depth_m.copy()
    )


def _stuck_in_part() -> Image:
    kept: list[Depth] = []

    def change(frame: DepthFrame, live: Live) -> DepthFrame:
        kept.append(live.newest[frame.camera].depth_m if not kept else kept[0])
        depth = frame.depth_m.copy()
        depth[: len(depth) // 2] = kept[0][: len(depth) // 2]
        return replace(frame, depth_m=depth)

    return change


def _slow() -> Image:
    """Every fifth image comes."""
    count = [0]

    def change(frame: DepthFrame, live: Live) -> DepthFrame | None:
        count[0] += 1
        return frame if count[0] % 5 == 0 else None

    return change


def _delayed() -> Image:
    """Each image comes 0.4 s late, with its true stamp."""
    waiting: list[DepthFrame] = []

    def change(frame: DepthFrame, live: Live) -> DepthFrame | None:
        waiting.append(frame)
        is_due = frame.stamp_ns is not None and frame.stamp_ns - (waiting[0].stamp_ns or 0) >= 400_000_000
        return waiting.pop(0) if is_due else None

    return change


def _intermittent() -> Image:
    """Bursts of four images, and nothing for four."""
    count = [0]

    def change(frame: DepthFrame, live: Live) -> DepthFrame | None:
        count[0] += 1
        return frame if count[0] % 8 >= 4 else None

    return change


def _stamped(by_ns: int) -> Callable[[str, standard.Random], Wrong]:
    return _images(lambda: lambda frame, live: replace(frame, stamp_ns=(frame.stamp_ns or 0) + by_ns))


def _off(camera: str, chance: standard.Random) -> Wrong:
    """Its frames are not among those handed out."""
    return OfSnapshots(lambda s, live: replace(s, frames=tuple(f for f in s.frames if f.camera != camera)))


def _swapped(camera: str, chance: standard.Random) -> Wrong:
    # of those that are exposed at the same ticks, so that stamps go on
    names = sorted(PLACES)
    other = chance.choice([name for name in names[names.index(camera) % 2 :: 2] if name != camera])
    made: dict[str, tuple[DepthFrame, DepthFrame]] = {}
    begun: list[int] = []

    def change(snapshot: Snapshot, live: Live) -> Snapshot:
        begun.append(snapshot.now_ns or 0)
        if min(f.stamp_ns or 0 for f in snapshot.frames if f.camera in (camera, other)) < begun[0]:
            return snapshot  # an image that was handed out is not handed out again
        of = {frame.camera: frame for frame in snapshot.frames}
        frames = []
        for frame in snapshot.frames:
            source = of.get({camera: other, other: camera}.get(frame.camera, frame.camera), frame)
            if source is not frame:
                # one new object for each image, as a driver would give it
                if frame.camera not in made or made[frame.camera][0] is not source:
                    made[frame.camera] = source, replace(source, camera=frame.camera)
                frame = made[frame.camera][1]
            frames.append(frame)
        return replace(snapshot, frames=tuple(frames))

    return OfSnapshots(change)


def _turned(camera: str, chance: standard.Random) -> Wrong:
    """About one of its axes, to one side or the other."""
    pose, turn = np.eye(4), [0.0, 0.0, 0.0]
    turn[chance.randrange(3)] = math.radians(chance.choice([-4, 4]))
    pose[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    return OfPlace(camera, pose)


def _pushed(camera: str, chance: standard.Random) -> Wrong:
    """Along one of its axes, to one side or the other."""
    pose = np.eye(4)
    pose[chance.randrange(3), 3] = chance.choice([-PUSHED_M, PUSHED_M])
    return OfPlace(camera, pose)


def _noise(depth: Depth) -> Depth:
    return np.random.default_rng().random(depth.shape, dtype=np.float32) * 6 + np.float32(0.1)


def _taken(share: float) -> Callable[[Depth], Depth]:
    """No return in so much of the image, from below."""

    def change(depth: Depth) -> Depth:
        taken = depth.copy()
        taken[round((1 - share) * len(depth)) :] = 0
        return taken

    return change


def _swapped_bytes(depth: Depth) -> Depth:
    return np.asarray((1000 * depth).astype(np.uint16).byteswap() / 1000, np.float32)


def _joints(change: Callable[[float, float], float | None]) -> Callable[[], Whole]:
    """Another position, by what it is and the time since the first [m], [s]; None: none comes."""

    def make() -> Whole:
        first: list[int] = []

        def changed(snapshot: Snapshot, live: Live) -> Snapshot:
            first.append(live.clock_ns())
            given = change((snapshot.joints or {})["slide"], (live.clock_ns() - first[0]) / 1e9)
            return replace(snapshot, joints=None if given is None else {"slide": given})

        return changed

    return make


def _joints_kept(stamp: bool, value: bool) -> Callable[[], Whole]:
    """Their stamp, or their value, or both, stand still."""

    def make() -> Whole:
        kept: list[Snapshot] = []

        def change(snapshot: Snapshot, live: Live) -> Snapshot:
            kept.append(snapshot)
            first = kept[0]
            if snapshot is first:
                return snapshot
            return replace(
                snapshot,
                joints=first.joints if value else snapshot.joints,
                joints_ns=first.joints_ns if stamp else snapshot.joints_ns,
            )

        return change

    return make


def _joints_slow() -> Whole:
    """A new row each half of a second."""
    kept: list[Snapshot] = []

    def change(snapshot: Snapshot, live: Live) -> Snapshot:
        if not kept or (snapshot.now_ns or 0) - (kept[0].now_ns or 0) > 500_000_000:
            kept[:] = [snapshot]
            return snapshot
        return replace(snapshot, joints=kept[0].joints, joints_ns=kept[0].joints_ns)

    return change


def _clock(by_ns: int) -> Callable[[], Whole]:
    """The program's clock is set, once."""

    def make() -> Whole:
        done: list[bool] = []

        def change(snapshot: Snapshot, live: Live) -> Snapshot:
            if not done:
                done.append(True)
                live.ahead_ns += by_ns
            return replace(snapshot, now_ns=live.clock_ns())

        return change

    return make


FROZEN = ("joints_frozen",)
AWAY = ("joints_beyond", "joints_implausible")
SCALE, ENCODING = ("camera_wrong_scale",), ("camera_wrong_encoding",)
CLOCK = ("input clock", "camera_clock", "input order")
SILENT = ("silence",)
KINDS: Sequence[Kind] = (
    Kind("off", "camera", LATE, _off),
    Kind("silent, its last image stays", "camera", LATE, _images(lambda: lambda frame, live: None)),
    Kind("stuck image, stamps go on", "camera", ("camera_frozen",), _images(_stuck)),
    Kind("stuck, given again and again", "camera", ("camera_frozen", *LATE), _images(_stuck_whole)),
    Kind("stuck in its upper half", "camera", ("camera_frozen",), _images(_stuck_in_part)),
    Kind("garbage", "camera", ENCODING, _depth(_noise)),
    Kind("wrong: 0.7 m too far", "camera", SCALE, _depth(lambda depth: depth + np.float32(0.7))),
    Kind("slow: 3 Hz", "camera", LATE, _images(_slow)),
    Kind("delayed by 0.4 s", "camera", LATE, _images(_delayed)),
    Kind("intermittent", "camera", LATE, _images(_intermittent)),
    Kind("decalibrated: turned by 4 degrees", "camera", ("camera_moved", "watch"), _turned, True, 10.0),
    Kind("decalibrated: pushed by 6 cm", "camera", ("camera_moved", "watch"), _pushed, True, 10.0),
    Kind("covered", "camera", ("camera_covered",), _depth(_taken(1.0))),
    Kind("covered by half", "camera", ("camera_partly_covered",), _depth(_taken(0.5))),
    Kind("swapped", "camera", ("camera_swapped",), _swapped),
    Kind("wrong scale: a fourth", "camera", SCALE, _depth(lambda depth: depth / 4)),
    Kind("wrong scale: tenfold", "camera", SCALE, _depth(lambda depth: depth * 10)),
    Kind("wrong encoding: disparity", "camera", ENCODING, _depth(lambda depth: 2 / depth)),
    Kind("wrong encoding: bytes swapped", "camera", ENCODING, _depth(_swapped_bytes)),
    Kind("truncated", "camera", ("camera_wrong_size",), _depth(lambda depth: depth[:31])),
    Kind("wrong size", "camera", ("camera_wrong_size",), _depth(lambda depth: depth[::2, ::2])),
    Kind("clock back by 1 s", "camera", ("camera_clock", "camera_too_old"), _stamped(-1_000_000_000)),
    Kind("clock ahead by 1 s", "camera", ("camera_clock",), _stamped(1_000_000_000)),
    Kind("missing", "joints", ("joints_missing",), _whole(_joints(lambda at, s: None))),
    Kind(
        "intermittent",
        "joints",
        ("joints_missing",),
        _whole(_joints(lambda at, s: None if s % 0.4 < 0.2 else at)),
    ),
    Kind("stuck, while commanded to move", "joints", FROZEN, _whole(_joints_kept(False, True))),
    Kind("stuck with their stamp", "joints", FROZEN, _whole(_joints_kept(True, True))),
    Kind("stamp stands still", "joints", FROZEN, _whole(_joints_kept(True, False))),
    Kind("slow: 2 Hz", "joints", FROZEN, _whole(_joints_slow)),
    Kind("garbage: no number", "joints", AWAY, _whole(_joints(lambda at, s: math.nan))),
    Kind("implausible: a jump of 0.3 m", "joints", AWAY, _whole(_joints(lambda at, s: at + 0.3))),
    Kind("wrong scale: millimetres", "joints", AWAY, _whole(_joints(lambda at, s: 1000 * at + 10))),
    Kind("beyond a limit", "joints", ("joints_beyond",), _whole(_joints(lambda at, s: 0.6))),
    Kind("set back by 1 s", "clock", CLOCK, _whole(_clock(-1_000_000_000))),
    Kind("set ahead by 1 s", "clock", (*CLOCK, "camera_too_old"), _whole(_clock(1_000_000_000))),
    Kind("hangs: a source that waits 1 s", "process", SILENT),
    Kind("suspended for 1 s", "process", SILENT),
    Kind("starved of processor time", "process", (*SILENT, "stale")),
    Kind("short of memory", "process", ("fault", "silence", "unclean_end"), restarts=True),
    Kind("killed", "process", ("silence", "unclean_end"), restarts=True),
    Kind("watchdog killed", "process", ("watchdog",)),
)
"""All of them."""


def kind_named(name: str, of: str) -> Kind:
    """The kind of this name, of this input.

    Args:
        name: of the fault.
        of: what it is thrown at.

    Raises:
        KeyError: there is none.
    """
    return {(kind.name, kind.input): kind for kind in KINDS}[name, of]
