"""The gate of a room, as its site says it should be."""

import hashlib
from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.extras import package
from elbowroom.guard.link import WatchdogLink
from elbowroom.guard.registers import register_count
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.site.gate_entry import GateEntry
from elbowroom.sources import Room

MS = 1_000_000


def gate_of(room: Room, folder: Path | None = None, callback: str | None = None) -> Gate | None:
    """The gate that a run of a room has; None: nobody asked for one.

    Args:
        room: with its site.
        folder: of the latch; None: as the site says.
        callback: "package.module:function" or "file.py:function" that is told each decision; a site names none, as
            opening a site runs nobody's code. None: nobody is called.

    Raises:
        InputError: the site has a gate and nobody says where its latch lies; or no motion is judged, or more than an
            output can tell; or the machine stood in none of the images.
        PackageError: the site asks for Modbus, and pymodbus is not installed.
    """
    entry = room.site.entry.gate
    if entry is not None and folder is None:
        folder = entry.folder_path(room.site.path.parent)
        if folder is None:
            raise InputError(
                f"{room.site.path}: gate: no folder for the latch; write gate.folder, or give --gate"
            )
    if folder is None:
        if callback is not None:
            raise InputError("callback: there is no gate that could call it; give --gate")
        return None
    if room.terms.without_machine:
        raise InputError(
            f"{room.site.path}: gate: the machine stood in none of the images (recording.without_machine), so nothing "
            "that they show can let it move; leave the gate or that key out"
        )
    entry = entry or GateEntry()
    if room.unasked is not None:
        raise InputError(f"{room.site.path}: gate: {room.unasked}, so there is nothing to let through")
    _, motions = room.machine_and_motions()
    names = tuple(motion.name for motion in motions)
    rules = Rules(
        names, round(entry.deadline_ms * MS), entry.rise_per_s, entry.low_speed, round(entry.hold_ms * MS)
    )
    watchdog = WatchdogLink(
        {
            "motions": names,
            "deadline_ns": rules.deadline_ns,
            "callback": callback,
            "modbus": _address(entry, len(names)),
        }
    )
    return Gate(folder, identity(room.site.name, names), rules, watchdog)


def identity(name: str, motions: tuple[str, ...]) -> str:
    """What a latch is of: the site's name, and which motions are judged there.

    Args:
        name: of the site.
        motions: their names.
    """
    return (
        f"{name} ({len(motions)} motions, {hashlib.sha256(chr(10).join(motions).encode()).hexdigest()[:8]})"
    )


def _address(entry: GateEntry, motions: int) -> tuple[str, int] | None:
    """Where a PLC polls, if the site says so.

    Raises:
        InputError, PackageError: as `gate_of`.
    """
    if entry.modbus is None:
        return None
    register_count(motions)
    package("pymodbus")
    return entry.modbus.host, entry.modbus.port
