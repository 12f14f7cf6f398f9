"""The newest frames of all cameras -> free space: the main job up to where motion begins."""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import Detail, Rule
from elbowroom.errors import ValueWarning
from elbowroom.geometry import DepthCamera, VoxelGrid, parallel
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.reconstruct.ages import aged_m
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.declared import declared_words
from elbowroom.reconstruct.explained import explain
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.reconstruct.images import frames_by_camera, room_images
from elbowroom.reconstruct.looking import found_in_space, require_plausible
from elbowroom.reconstruct.own_body import own_body
from elbowroom.reconstruct.parts import KeptViews
from elbowroom.reconstruct.resolve import decide_around
from elbowroom.reconstruct.source import ImageSource
from elbowroom.reconstruct.terms import PEOPLE_SPEED_M_S, WITNESS_ANGLE_DEG, Terms
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot

Timer = Callable[[str], AbstractContextManager[None]]
"""Called with the name of a stage, returns a context manager around it."""


def reconstruct(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    machine: Machine | None = None,
    joints: Mapping[str, float] | JointRecord | None = None,
    *,
    rule: Rule = "three",
    detail: Detail = "pixel",
    margin: Margin | None = None,
    now_ns: int | None = None,
    max_age_ns: int | None = None,
    explain_tolerance_m: float = 0.01,
    body_growth_m: float | None = None,
    focus: NDArray[np.bool_] | None = None,
    witness_angle_deg: float = WITNESS_ANGLE_DEG,
    people_speed_m_s: float = PEOPLE_SPEED_M_S,
    nothing_moves: bool = False,
    threads: int | None = None,
    timer: Timer | None = None,
    looks: bool = True,
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
        body_growth_m: by how much the body is grown where it is taken out, at least a quarter voxel [m]; None: by
            what a pixel covers (`growth.growth_of`).
        focus: blocks of 4 voxels that are looked at, of `motion.blocks_in_reach`; all others stay unseen. None: all.
        witness_angle_deg: by rule `three`, cameras nearer to each other than this, as seen from the grid, are one
            witness [deg]; 0: each is one.
        people_speed_m_s: the most that anything but the machine moves [m/s]: what a camera saw to be free holds at
            `now_ns`, or at the newest frame's time, for what such a thing cannot have reached since.
        nothing_moves: nothing but the machine moves here; goes with a speed of 0, and only with that.
        threads: None: all cores. The result does not depend on it.
        timer: called with the name of each stage, returns a context manager around it; None: nobody measures.
        looks: whether values are looked at, at the first moments of these cameras: units, numbers that stand for no
            return, lenses and poses that cannot be meant so.

    Returns:
        The space; it keeps the images, for `FreeSpace.explain` and to look again (`FreeSpace.released` lets go).

    Raises:
        CameraError, FrameError: two frames of one camera, a frame of an unknown camera or of another size.
        MachineError: joints that are unknown, missing or out of their limits, or a growth below a quarter voxel.
        InputError: an unknown rule or detail, a machine without joints, an age limit without the time.
        ImplausibleError: values that read as valid and cannot be meant so.

    Warns:
        ValueWarning: values that are most likely not meant so.
    """
    terms = Terms(
        rule,
        detail,
        margin or Margin(),
        max_age_ns,
        explain_tolerance_m,
        body_growth_m,
        witness_angle_deg=witness_angle_deg,
        people_speed_m_s=people_speed_m_s,
        nothing_moves=nothing_moves,
    )
    snapshot = Snapshot.taken(frames, None if machine is None else joints, now_ns, max_age_ns)
    is_first = False
    if looks:
        frames_by_camera(cameras, frames)  # a frame of another size cannot be looked at
        is_first = require_plausible(grid, cameras, frames, terms.margin)
    with parallel.threads(threads):
        space = free_space_of(grid, cameras, snapshot, machine, terms, focus=focus, timer=timer)
    for finding in found_in_space(space) if is_first and focus is None else ():
        warnings.warn(finding.text, ValueWarning, stacklevel=2)
    return space


def free_space_of(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    snapshot: Snapshot,
    machine: Machine | None,
    terms: Terms,
    *,
    focus: NDArray[np.bool_] | None = None,
    timer: Timer | None = None,
) -> FreeSpace:
    """Space seen to be free at one moment: what `reconstruct` does with its values.

    Args:
        grid: the watched box.
        cameras: all cameras of the room.
        snapshot: their newest frames, and where the machine was.
        machine: whose body is explained and taken out, unless it stood in no image; None: the bare room.
        terms: how strictly space is judged.
        focus, timer: as of `reconstruct`.

    Raises:
        CameraError, FrameError, MachineError, InputError: as `reconstruct`.
    """
    stage = timer or _untimed
    frames_by_camera(cameras, snapshot.frames)  # a frame past its age must be of this room, too
    fresh = snapshot.fresh(terms.max_age_ns)
    images = room_images(cameras, fresh.frames, aged_m(cameras, fresh, terms))
    machine = None if terms.without_machine else machine
    with stage("explain"):
        explained = explain(grid, machine, images, fresh, terms)
        # what is free as body whatever cameras say is not asked of them
        own = own_body(grid, cameras, machine, fresh.joints_at_newest, terms)
        explained = replace(explained, decided_words=own.decided(explained.unexplained_words))
    with stage("carve"):
        kept: list[KeptViews] = []
        evidence = carve_images(
            grid, images, explained, terms, complete=terms.needs_counts, focus=focus, kept=kept
        )
    with stage("resolve"):
        space = decide_around(evidence, cameras, own, terms)
    source = ImageSource(images, explained.model_depth, terms, space.free_words, focus, tuple(kept))
    space = replace(space, source=source, looked_at=focus)
    if machine is None or not machine.contacts:
        return space
    with stage("contacts"):
        near = declared_words(grid, cameras, images, fresh, machine, terms, focus)
    return replace(space, declared=near)


@contextmanager
def _untimed(_: str) -> Iterator[None]:
    yield
