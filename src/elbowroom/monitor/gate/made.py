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


def gate_of(room: Room, folder: Path | None = None) -> Gate | None:
    """The gate that a run of a room has; None: nobody asked for one.

    Args:
        room: with its site.
        folder: of the latch; None: as the site says.

    Raises:
        InputError: the site has a gate and nobody says where its latch lies; or no motion is judged, or more than an
            output can tell.
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
        return None
    entry = entry or GateEntry()
    if room.unasked is not None:
        raise InputError(f"{room.site.path}: gate: {room.unasked}, so there is nothing to let through")
    _, motions = room.machine_and_motions()
    names = tuple(motion.name for motion in motions)
    rules = Rules(
        names, round(entry.deadline_ms * MS), entry.rise_per_s, entry.low_speed, round(entry.hold_ms * MS)
    )
    return Gate(
        folder, identity(room.site.name, names), rules, _watchdog(entry, rules, room.site.path.parent)
    )


def identity(name: str, motions: tuple[str, ...]) -> str:
    """What a latch is of: the site's name, and which motions are judged there.

    Args:
        name: of the site.
        motions: their names.
    """
    return (
        f"{name} ({len(motions)} motions, {hashlib.sha256(chr(10).join(motions).encode()).hexdigest()[:8]})"
    )


def _watchdog(entry: GateEntry, rules: Rules, beside: Path) -> WatchdogLink:
    """The watchdog, with the outputs that the site names."""
    modbus, callback = entry.modbus, entry.callback
    if modbus is not None:
        register_count(len(rules.motions))
        package("pymodbus")
    if callback is not None and callback.rpartition(":")[0].endswith(".py"):
        callback = str(beside.absolute() / callback)
    return WatchdogLink(
        {
            "motions": rules.motions,
            "deadline_ns": rules.deadline_ns,
            "callback": callback,
            "modbus": None if modbus is None else [modbus.host, modbus.port],
        }
    )
