"""What the checks of a motion and of a path begin with: the space at a moment, with its steps shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console

from elbowroom.cli.progress import Steps
from elbowroom.machine import Machine
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.reconstruct import FreeSpace, warm_up
from elbowroom.reconstruct.looking import refuse
from elbowroom.reconstruct.machine_there import machine_there
from elbowroom.sensing import Snapshot
from elbowroom.sources import Room


@contextmanager
def checked_space(
    room: Room, machine: Machine, moment: int, checking: str
) -> Iterator[tuple[FreeSpace, Snapshot]]:
    """The space at a moment, and what it was made of; what is done within is the last step that is shown.

    Args:
        room: with the machine.
        machine: of the room.
        moment: its number, from 0.
        checking: what the last step is called.
    """
    console = Console(stderr=True)
    compile_kernels(console, machine=True, motion=True, simulator=room.site.simulated is not None)
    with Steps(console, 4) as steps:
        steps.begin("loading kernels")
        warm_up(machine, [room.terms.detail])
        steps.begin("reading images")
        snapshot = room.placed(room.snapshot(moment))
        is_absent = room.terms.without_machine
        refuse(machine_there(machine, room.cameras, snapshot, is_absent=is_absent))
        steps.begin("reconstructing")
        space = room.space_of(snapshot)
        steps.begin(checking)
        yield space, snapshot


def said_of(room: Room, moment: int, snapshot: Snapshot) -> dict[str, Any]:
    """What a row of a check says of where and when it was.

    Args:
        room, moment, snapshot: as of `checked_space`.
    """
    return {
        "site": room.site.name,
        "moment": moment,
        "voxel_size_m": room.grid.voxel_size_m,
        "rule": room.terms.rule,
        "detail": room.terms.detail,
        "joints": snapshot.joints,
    }
