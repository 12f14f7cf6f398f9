"""The newest frames of all cameras -> free space: the main job up to where motion begins."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine, explain_frames
from elbowroom.reconstruct.carve import Detail, carve_images
from elbowroom.reconstruct.free_space import FreeSpace, Source
from elbowroom.reconstruct.images import frames_by_camera, room_images
from elbowroom.reconstruct.resolve import Rule, needs_complete, resolve
from elbowroom.sensing import DepthFrame, JointRecord
from elbowroom.sensing.snapshot import Snapshot, young_enough

Joints = Mapping[str, float] | JointRecord
Timer = Callable[[str], AbstractContextManager[None]]


def reconstruct(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    machine: Machine | None = None,
    joints: Joints | None = None,
    *,
    rule: Rule = "three",
    detail: Detail = "pixel",
    margin: Margin | None = None,
    now_ns: int | None = None,
    max_age_ns: int | None = None,
    explain_tolerance_m: float = 0.01,
    body_growth_m: float | None = None,
    focus: NDArray[np.bool_] | None = None,
    threads: int | None = None,
    timer: Timer | None = None,
) -> FreeSpace:
    """Space seen to be free, from one frame of each camera and nothing older.

    Args:
        grid: the watched box.
        cameras: all cameras of the room. One that has no frame, or only one past its age, disputes all that it
            looks at.
        frames: at most one of each camera.
        machine: whose body is explained in the images and taken out of the volume; None: the bare room.
        joints: its positions by name [m or rad], or a record to be asked at each frame's time. The body is taken out
            where it is at the newest frame's time.
        rule: `three` (default), `majority`, `veto`, `any`: see `resolve`.
        detail: `pixel` (default), `footprint`, `point`: see `carve`.
        margin: for cameras without one of their own; None: `Margin()`: 3 sigma, half a pixel.
        now_ns: the time now [ns, the clock of the frames]; needed for an age limit.
        max_age_ns: frames older than this are not used [ns]; None: no limit.
        explain_tolerance_m: how near to the machine's model a return counts as the machine, besides its noise [m].
        body_growth_m: by how much the body is grown where it is taken out, at least a quarter voxel [m]; None: half a
            voxel.
        focus: blocks of 4 voxels that are looked at, of `motion.blocks_in_reach`; all others stay unseen. None: all.
        threads: None: all cores. The result does not depend on it.
        timer: called with the name of each stage, returns a context manager around it; None: nobody measures.

    Raises:
        CameraError, FrameError: two frames of one camera, a frame of an unknown camera or of another size.
        MachineError: joints that are unknown, missing or out of their limits, or a growth below a quarter voxel.
        InputError: an unknown rule or detail, a machine without joints, an age limit without the time.
    """
    frames_by_camera(cameras, frames)
    fresh = young_enough(frames, now_ns, max_age_ns)
    return free_space_of(
        grid,
        cameras,
        Snapshot.taken(fresh, joints if machine is not None else None, now_ns),
        machine,
        rule=rule,
        detail=detail,
        margin=margin,
        explain_tolerance_m=explain_tolerance_m,
        body_growth_m=body_growth_m,
        focus=focus,
        threads=threads,
        timer=timer,
    )


def free_space_of(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    snapshot: Snapshot,
    machine: Machine | None,
    *,
    rule: Rule = "three",
    detail: Detail = "pixel",
    margin: Margin | None = None,
    max_age_ns: int | None = None,
    explain_tolerance_m: float = 0.01,
    body_growth_m: float | None = None,
    focus: NDArray[np.bool_] | None = None,
    threads: int | None = None,
    timer: Timer | None = None,
) -> FreeSpace:
    """Space seen to be free at one moment; arguments as of `reconstruct`."""
    stage = timer or _untimed
    complete = needs_complete(rule)
    frames_by_camera(cameras, snapshot.frames)
    images = room_images(cameras, snapshot.fresh(max_age_ns).frames)
    model_depth, unexplained, here = None, None, None
    if machine is not None:
        here = snapshot.joints
        if here is None:
            raise InputError("reconstruct: a machine without joints; give its joint positions by name")
        with stage("explain"):
            seen = [camera for camera in images.cameras if camera.name in images.least_m]
            explained = explain_frames(
                machine,
                seen,
                [images.least_m[camera.name] for camera in seen],
                [snapshot.joints_at(camera.name) or {} for camera in seen],
                tolerance_m=explain_tolerance_m,
                grid=grid,
                threads=threads,
                growth_m=body_growth_m,
            )
        model_depth, unexplained = explained.model_depth, explained.unexplained_words
    with stage("carve"):
        evidence = carve_images(
            grid,
            images,
            detail=detail,
            margin=margin,
            complete=complete,
            model_depth=model_depth,
            unexplained=unexplained,
            focus=focus,
            threads=threads,
        )
    with stage("resolve"):
        return resolve(
            evidence,
            cameras,
            rule=rule,
            detail=detail,
            margin=margin,
            machine=machine,
            joints=here,
            body_growth_m=body_growth_m,
            source=Source(images, margin or Margin(), detail, rule, model_depth or {}, focus),
            threads=threads,
        )


@contextmanager
def _untimed(_: str) -> Iterator[None]:
    yield
