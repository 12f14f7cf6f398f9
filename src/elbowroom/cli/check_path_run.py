"""The run of `elbowroom check --path`: a moment, a path, how far it may be followed and why no farther."""

from collections.abc import Iterator
from pathlib import Path

from elbowroom.cli.check_run import by_the_sites_word
from elbowroom.cli.checked_space import checked_space, said_of
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.motion import Blocked, PathVerdict, check_path, read_path
from elbowroom.sources import Room
from elbowroom.view.screen.words import NOT_CERTIFIED


def ask_path(room: Room, asked: tuple[Path, float | None], moment: int, json_file: Path | None) -> None:
    """Checks one path and prints the verdict.

    Args:
        room: with a machine.
        asked: the path's file, and how far ahead to look [s]; None: all of it.
        moment: number of the moment, from 0; the path begins there.
        json_file: where the row goes; None: nowhere.

    Raises:
        InputError: no machine, no speeds, no such moment, or a path that is none of this machine here.
    """
    machine, _ = room.machine_and_motions()
    path, braking = read_path(asked[0]), room.site.braking(machine)
    with json_rows(json_file) as add:
        with checked_space(room, machine, moment, "checking the path") as (space, snapshot):
            try:
                verdict = check_path(space, machine, path, snapshot.joints or {}, braking, asked[1])
            except InputError as error:
                raise type(error)(f"{asked[0]}: {error}") from None
        add(
            {
                **said_of(room, moment, snapshot),
                "path": str(asked[0]),
                **verdict.row(),
                "reaction_time_s": braking.reaction_time_s,
                "leaves_path": braking.leaves_path,
                "unchecked_links": machine.unchecked_links,
                "bodiless_links": machine.bodiless_links,
                "allowances": room.allowances,
            }
        )
    for line in _said(verdict, braking.leaves_path):
        print(line)
    for line in by_the_sites_word(machine, room.allowances):
        print(line)
    print(NOT_CERTIFIED)


def _said(verdict: PathVerdict, leaves_path: bool) -> Iterator[str]:
    """The verdict in words."""
    path, stop = verdict.path, verdict.level.name.lower()
    brakes = "each joint braking by itself" if leaves_path else "braking along the path, by the site's word"
    begin_s, end_s = path.begin_s, path.end_s
    if verdict.follow_until_s is None:
        yield f"Path: {stop}. Not even a stop that is commanded at once, {brakes}, ends in free space."
    elif verdict.is_free:
        yield (
            f"Path: {stop}. All of it may be followed, {begin_s:.2f} to {end_s:.2f} s; every stop from it, {brakes}, "
            "is free."
        )
    else:
        yield (
            f"Path: {stop}. It may be followed until {verdict.follow_until_s:.2f} s of {begin_s:.2f} to {end_s:.2f} s: "
            f"a stop that is commanded by then, {brakes}, ends in free space, on the path by "
            f"{verdict.rests_by_s or 0.0:.2f} s."
        )
    if verdict.blocked is not None:
        yield f"The path meets {_what(verdict.blocked)}, at {verdict.blocked.time_s:.2f} s."
    if verdict.stop_blocked is not None:
        yield (
            f"A stop that is commanded at {verdict.stop_blocked.time_s:.2f} s meets {_what(verdict.stop_blocked)}, "
            "beside the path."
        )
    if not verdict.is_free and verdict.first is None:
        yield f"Looked at until {verdict.looked_until_s:.2f} s, and nothing is in the way so far."
    if verdict.escapes:
        yield "It leads out of blocked space that the machine stands in or close beside."


def _what(blocked: Blocked) -> str:
    """What is met, by which link, where."""
    met = blocked.other_link or blocked.zone
    what = blocked.cause.value + (f", {met}" if met else "")
    if blocked.place_in_world is None:
        return f"{what}, with {blocked.link}"
    x, y, z = blocked.place_in_world
    return f"{what}, with {blocked.link} at x {x:.3f}, y {y:.3f}, z {z:.3f} m"
