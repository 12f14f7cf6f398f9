"""The run of `elbowroom check`: a moment, a motion, a verdict and its reasons."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from elbowroom.cli.checked_space import checked_space, said_of
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.machine import Machine
from elbowroom.monitor.why.why import Why, why
from elbowroom.motion import Cause, Creep, Motion, Verdict, check_motions, with_creep
from elbowroom.reconstruct import FreeSpace
from elbowroom.reconstruct.point_report import Sight
from elbowroom.reconstruct.source import ImageSource
from elbowroom.sources import Room
from elbowroom.view.draw.voxel_crop import save_voxel_crops
from elbowroom.view.screen.words import NOT_CERTIFIED, travel_text


def ask(
    room: Room, asked: tuple[str, int], moment: int, json_file: Path | None, out: Path | None = None
) -> None:
    """Checks one motion and prints the verdict.

    Args:
        room: with a machine.
        asked: joint and direction of the motion; +1 or -1.
        moment: number of the moment, from 0.
        json_file: where the row goes; None: nowhere.
        out: where pictures of the voxel that ends the way go; None: nowhere.

    Raises:
        InputError: no machine, no such joint, no speed for it, or no such moment.
    """
    machine, motions = room.machine_and_motions()
    joint = machine.joint(asked[0]).name
    motion = next((m for m in motions if (m.joint, m.direction) == asked), None)
    if motion is None:
        known = ", ".join(dict.fromkeys(m.joint for m in motions))
        raise InputError(f"{room.site.path}: joints.{joint}: no speed; joints with a speed are {known}")
    with json_rows(json_file) as add:
        with checked_space(room, machine, moment, "checking the motion") as (space, snapshot):
            checked = check_motions(space, machine, snapshot.joints or {}, [motion])
            override = room.site.override(machine)
            (verdict,) = with_creep(space, machine, snapshot.joints or {}, checked, override)
        found = why(space, machine, snapshot.joints or {}, verdict)
        reasons = reasons_of(found, verdict)
        pictures = _pictures(space, found, out)
        add(
            {
                **said_of(room, moment, snapshot),
                **verdict.row(),
                "explanation": reasons,
                "seen": [] if found.report is None else [seen.row() for seen in found.report.cameras],
                "outside_m": found.outside_m,
                "advice": list(found.advice),
                "pictures": [str(path) for path in pictures],
                "unchecked_links": machine.unchecked_links,
                "bodiless_links": machine.bodiless_links,
                "allowances": room.allowances,
            }
        )
    for line in said(motion, verdict):
        print(line)
    for line in [*reasons, *numbers(found), *map(sentence, found.advice)]:
        print(line)
    if pictures:
        print(f"{len(pictures)} pictures, one of each camera that has the voxel in its image, in {out}")
    for line in by_the_sites_word(machine, room.allowances):
        print(line)
    print(NOT_CERTIFIED)


def said(motion: Motion, verdict: Verdict) -> Iterator[str]:
    """The verdict in words."""
    yield f"{verdict.motion.name}: {verdict.level.value}"
    yield _travel(motion, verdict)
    if verdict.place_in_world is not None:
        x, y, z = verdict.place_in_world
        met = verdict.other_link or verdict.zone
        what = verdict.cause.value + (f", {met}" if met else "")
        yield f"What ends it: {what}; {verdict.link} at x {x:.3f}, y {y:.3f}, z {z:.3f} m."
    if verdict.creep is not None:
        yield _creeping(verdict, verdict.creep)
    if verdict.escapes:
        yield "It leads out of blocked space that the machine stands in or close beside."


def by_the_sites_word(machine: Machine, allowances: Sequence[str]) -> Iterator[str]:
    """What is not looked at, as every summary says it.

    Args:
        machine: says which of its links.
        allowances: of the room.
    """
    if machine.unchecked_links:
        yield f"Not checked, by the site's word: {', '.join(machine.unchecked_links)}."
    if machine.bodiless_links:
        yield f"Without a body, by the site's word: {', '.join(machine.bodiless_links)}."
    yield from (f"{line}." for line in allowances)


def _travel(motion: Motion, verdict: Verdict) -> str:
    free, looked_at, brakes = (
        travel_text(distance, verdict.free_travel_unit)
        for distance in (verdict.free_travel, motion.looked_at, motion.braking_distance)
    )
    return (
        f"Free travel: {free} of {looked_at} looked at; it brakes within {brakes}. "
        f"Greatest safe speed: {100 * verdict.safe_speed:.0f} % of full speed."
    )


def _creeping(verdict: Verdict, creep: Creep) -> str:
    """How far an operator may creep, how fast, and what ends that."""
    travel, speed, brakes = (
        travel_text(value, verdict.free_travel_unit)
        for value in (creep.travel, creep.speed, creep.braking_distance)
    )
    ends = "nothing else is in the way as far as was looked"
    if creep.cause is not Cause.NONE:
        ends = f"then {creep.cause.value}: {creep.link}"
    if creep.place_in_world is not None:
        x, y, z = creep.place_in_world
        ends += f" at x {x:.3f}, y {y:.3f}, z {z:.3f} m"
    if creep.travel <= 0:
        return f"Nobody sees that space, and there is no room to creep at {speed}/s, which brakes in {brakes}: {ends}."
    return (
        f"Nobody sees that space: an operator who holds on may creep {travel}, at {speed}/s at most, where it brakes "
        f"within {brakes}; {ends}."
    )


def numbers(found: Why) -> list[str]:
    """A line for each camera that has the voxel in its image and does not see through it."""
    seen = () if found.report is None else found.report.cameras
    return [f"  {one}" for one in seen if one.reach_m is not None and one.sight is not Sight.THROUGH]


def sentence(words: str) -> str:
    """The words as a sentence."""
    return f"{words[0].upper()}{words[1:]}."


def reasons_of(found: Why, verdict: Verdict) -> list[str]:
    """What each camera saw at the place that ends the travel, a line each; nothing if that lies nowhere.

    Of the machine itself: what to do if its links are meant to touch.
    """
    if verdict.cause is Cause.MACHINE:
        return [
            f"{verdict.link} and {verdict.other_link} may be meant to touch: then name both in the site's machine: "
            "allowed_contacts."
        ]
    if verdict.cause is Cause.KEPT_OUT:
        return [f"{verdict.zone} is a zone that the site keeps all links out of, whatever is seen there."]
    return [] if found.report is None else str(found.report).splitlines()


def _pictures(space: FreeSpace, found: Why, out: Path | None) -> list[Path]:
    """What each camera saw about the voxel; none where nothing is asked for, or where the travel ends nowhere."""
    if out is None or found.report is None or not isinstance(space.source, ImageSource):
        return []
    return save_voxel_crops(out, space.source, space.grid, found.report)
