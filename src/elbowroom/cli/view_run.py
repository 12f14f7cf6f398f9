"""The run of `elbowroom view`: what is there and what is found becomes layers, and those a picture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from elbowroom.cli.placement.room import room_of
from elbowroom.cli.progress import Steps
from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.motion import Level, Verdict, check_motions
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.reconstruct import FreeSpace, warm_up
from elbowroom.sensing import Snapshot
from elbowroom.simulate import InterventionRoom, Moment, render
from elbowroom.simulate.rounds import walking_staff
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.simulated import Simulated
from elbowroom.view.draw.outline import triangles_of
from elbowroom.view.draw.palette import CAMERA_INK, IN_3D, LEVEL_COLOURS, Colour, Label
from elbowroom.view.picture.fixed import MACHINE, machine_layer, measured_layer, people_layer, room_layer
from elbowroom.view.picture.layer import Layer, Lines, Subject, Word
from elbowroom.view.picture.picture import format_of, picture_of, save_picture
from elbowroom.view.picture.seen import blocked_layers, camera_bodies, frusta, sweep_layers
from elbowroom.view.picture.viewpoint import Viewpoint, checked_size, looking, standard

MOST_NAMED = 40
"""So many cameras are named."""
NEAR_M = 0.5
REACH_M, REACH_SHARE = 0.35, 0.1
"""Fields of view are drawn so far, but to no more than this share of what is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """What shall be drawn.

    Args:
        name: of a standard view.
        eye_m, target_m: instead of it; None: the standard view, the box's middle.
        field_deg: field of view from `eye_m` [deg].
        size_px: of the picture.
        parts: of `cli.view.PARTS`.
        sweeps: joints and directions whose motions are shown; None: all.
        near_m: blocked space so near the machine [m], 0: all; None: 0.5 m, none without a machine.
        reach_m: so far fields of view are drawn [m]; None: by the size of what is shown.
        moment: of the recording, from 0; of a simulated room, second.
    """

    name: str
    eye_m: tuple[float, float, float] | None
    target_m: tuple[float, float, float] | None
    field_deg: float
    size_px: tuple[int, int]
    parts: tuple[str, ...]
    sweeps: tuple[tuple[str, int], ...] | None
    near_m: float | None
    reach_m: float | None
    moment: int


@dataclass(frozen=True, slots=True, eq=False)
class There:
    """What is there, and what is found of it.

    Args:
        site: the file.
        cameras: as they hang.
        machine: None: there is none.
        fixed: the site's own room; None: it describes none.
        joints: where the machine is; empty without one.
        snapshot: None: there are no images.
        moment: what is really there, of a modelled room; None: nobody knows.
        space: None: not asked, or there are no images.
        verdicts: of the motions that are shown.
    """

    site: Site
    cameras: tuple[DepthCamera, ...]
    machine: Machine | None
    fixed: FixedRoom | None
    joints: Mapping[str, float]
    snapshot: Snapshot | None = None
    moment: Moment | None = None
    space: FreeSpace | None = None
    verdicts: tuple[Verdict, ...] = ()


def draw(site: Site, out: Path, asked: Asked, how: Mapping[str, Any]) -> None:
    """Draws the site and writes the picture.

    Args:
        site: the file.
        out: where the picture goes.
        asked: what shall be drawn.
        how: keywords of `open_room`.

    Raises:
        InputError: a name, a point, a size, a motion or a moment that is none.
    """
    format_of(out)
    checked_size(asked.size_px)
    console = Console(stderr=True)
    compile_kernels(console, machine=site.entry.has_machine, motion=True, simulator=True)
    with Steps(console, 3) as steps:
        steps.begin("reading the site")
        there = _there(site, asked, how)
        steps.begin("finding what is free")
        there = _found(there, asked, how)
        steps.begin("drawing")
        view = _viewpoint(there, asked)
        save_picture(picture_of(_subject(there, asked, view), view), out)
    for verdict in there.verdicts:
        print(f"{verdict.motion.name}: {verdict.level.value}")
    print(f"{out} written")


def _there(site: Site, asked: Asked, how: Mapping[str, Any]) -> There:
    fixed, machine, joints = room_of(site), site.machine(), how.get("joints")
    has_images = site.simulated is not None or (
        site.entry.recording is not None and site.missing_recording is None
    )
    if not has_images:
        if machine is not None:
            joints = machine.nearest_to_zero() if joints is None else dict(joints)
            machine.positions(joints)
        cameras = site.cameras() if site.lists_cameras else ()
        return _with_rendered(There(site, cameras, machine, fixed, joints or {}))
    room = open_room(site, **how)
    snapshot, moment = _moment_of(room, asked.moment)
    return There(site, room.cameras, room.machine, fixed, snapshot.joints or {}, snapshot, moment)


def _moment_of(room: Room, number: int) -> tuple[Snapshot, Moment | None]:
    """What cameras saw, and what was really there, if anybody knows."""
    if not isinstance(room.source, Simulated):
        return room.placed(room.snapshot(number)), None
    snapshot = next(room.source.at([float(number)]))
    there = InterventionRoom(machine=room.machine, staff=walking_staff())
    return snapshot, there.at(float(number), joints=room.source.joints)


def _with_rendered(there: There) -> There:
    """With images that the cameras would take of the site's room; without a room, or cameras, there are none."""
    if there.fixed is None or not there.cameras:
        return there
    from elbowroom.simulate.machine_solids import link_solids

    links = () if there.machine is None else link_solids(there.machine, there.joints)
    moment = Moment(1.0, there.fixed.moment.solids + links, dict(there.joints))
    frames = render(there.cameras, moment, seed=1)
    snapshot = Snapshot(tuple(frames), there.joints or None, now_ns=moment.stamp_ns)
    return replace(there, snapshot=snapshot, moment=moment)


def _found(there: There, asked: Asked, how: Mapping[str, Any]) -> There:
    """With free space and verdicts, as far as they are shown."""
    wants = {"blocked", "sweeps"} & set(asked.parts)
    if there.snapshot is None or not wants:
        return there
    room = open_room(there.site, **how)
    warm_up(there.machine, [room.terms.detail])
    space = room.space_of(there.snapshot)
    verdicts: list[Verdict] = []
    if there.machine is not None and "sweeps" in asked.parts and room.unasked is None:
        motions = there.site.motions(there.machine)
        if asked.sweeps is not None:
            motions = tuple(
                m for m in motions if (m.joint, m.direction) in _meant(there.machine, asked.sweeps)
            )
        verdicts = check_motions(space, there.machine, there.joints, motions)
    return replace(there, space=space, verdicts=tuple(verdicts))


def _meant(machine: Machine, sweeps: Sequence[tuple[str, int]]) -> set[tuple[str, int]]:
    """Joints by their full names, with directions."""
    return {(machine.joint(name).name, direction) for name, direction in sweeps}


def _box(there: There) -> NDArray[np.float64]:
    """What a standard view shows, shape (2, 3) [m]."""
    grid = there.site.grid()
    corners = [grid.lower_m[None], grid.upper_m[None], *(c.centre_in_world[None] for c in there.cameras)]
    if there.fixed is not None and there.fixed.walls_m is not None:
        corners.append(there.fixed.walls_m)
    every = np.concatenate(corners)
    return np.stack([every.min(axis=0), every.max(axis=0)])


def _viewpoint(there: There, asked: Asked) -> Viewpoint:
    if asked.eye_m is None:
        if asked.target_m is not None:
            raise InputError("--to: only with --from")
        return standard(asked.name, _box(there), asked.size_px)
    middle = there.site.grid().lower_m + there.site.grid().upper_m
    target = tuple((middle / 2).tolist()) if asked.target_m is None else asked.target_m
    return looking(asked.eye_m, target, asked.size_px, asked.field_deg)


def _subject(there: There, asked: Asked, view: Viewpoint) -> Subject:
    """All that is shown, with its legend."""
    layers, lines, words = list[Layer](), list[Lines](), tuple[Word, ...]()
    legend, extent_m = list[tuple[Colour, str]](), float(np.linalg.norm(np.diff(_box(there), axis=0)))
    if "room" in asked.parts:
        layers += _surroundings(there, view)
    if "machine" in asked.parts and there.machine is not None:
        layers.append(machine_layer(there.machine, there.joints))
        legend.append((tuple(round(255 * c ** (1 / 2.2)) for c in MACHINE), there.machine.name))
    if "cameras" in asked.parts and there.cameras:
        reach_m = min(REACH_M, REACH_SHARE * extent_m) if asked.reach_m is None else asked.reach_m
        fields, names = frusta(there.cameras, reach_m)
        lines.append(fields)
        layers.append(camera_bodies(there.cameras, extent_m))
        words = names if len(names) <= MOST_NAMED else ()
        legend.append((CAMERA_INK, f"{len(there.cameras)} cameras"))
    if "blocked" in asked.parts and there.space is not None:
        found, said = _blocked(there, there.space, asked.near_m)
        layers += found
        legend += said
    if there.verdicts and there.machine is not None:
        swept, crosses = sweep_layers(there.machine, there.joints, there.verdicts)
        layers += swept
        lines.append(crosses)
        legend += _levels(there.verdicts)
    return Subject(tuple(layers), tuple(lines), words, tuple(legend), there.site.name)


def _blocked(
    there: There, space: FreeSpace, near_m: float | None
) -> tuple[list[Layer], list[tuple[Colour, str]]]:
    """Space that is not free, as far as it is asked for, and its legend."""
    if near_m is None and there.machine is None:
        return [], []
    near_m = NEAR_M if near_m is None else near_m
    is_near = there.machine is not None and near_m > 0
    triangles = triangles_of(there.machine, there.joints) if there.machine is not None and is_near else None
    layers = list(blocked_layers(space, triangles, near_m))
    colours = (IN_3D[label] for label in (Label.SURFACE, Label.UNSEEN, Label.BLIND))
    texts = ("seen surface", "nobody sees it", "a camera is blind there")
    shown = [
        (colour, text)
        for colour, text, layer in zip(colours, texts, layers, strict=True)
        if len(layer.triangles)
    ]
    if shown and is_near:
        colour, text = shown[0]
        shown[0] = (colour, f"{text}, within {near_m:g} m of the machine")
    return layers, shown


def _surroundings(there: There, view: Viewpoint) -> list[Layer]:
    """The site's room and who is in it; without one, what its cameras measured."""
    if there.fixed is not None:
        people = [] if there.moment is None else [people_layer(there.moment.solids)]
        return [room_layer(there.fixed.moment.solids, there.fixed.walls_m, view), *people]
    if there.snapshot is None:
        return []
    return [measured_layer(there.cameras, there.snapshot.frames)]


def _levels(verdicts: Sequence[Verdict]) -> list[tuple[Colour, str]]:
    """Of each level that is there, its colour and its motions."""
    found = []
    for level in Level:
        names = [verdict.motion.name for verdict in verdicts if verdict.level is level]
        if names:
            found.append((LEVEL_COLOURS[level], f"{level.name.lower()}: {', '.join(names)}"))
    return found
