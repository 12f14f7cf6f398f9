"""The bytes that the monitor sends to its watchdog once a pass is finished: the decision, its number, its time.

    length    u16      of all that follows
    head      magic "EBRH", version u16, motions u16, sequence u64, finished_ns i64, deadline_ns u64, held_until_ns i64,
              trips_known u32, phase u16
    words     of the machine, then of each motion: per mille u16, reason u16, level u8, flags u8
    checksum  CRC-32 of head and words, u32

All big-endian.
"""

import struct
import zlib
from dataclasses import dataclass

from elbowroom.errors import InputError

VERSION = 1
MAGIC = b"EBRH"
LEVELS = ("stop", "decelerate", "inform", "clear")
"""By number, in the order of caution."""
PHASES = ("never", "starting", "guarding", "latched", "cleared", "ended", "silent")
"""By number: what the gate says of itself; *silent* is the watchdog's word."""
_HEAD = struct.Struct(">4sHHQqQqIH")
_WORD = struct.Struct(">HHBB")
_CHECKSUM = struct.Struct(">I")
LENGTH = struct.Struct(">H")
HELD, ESCAPES = 1, 2


@dataclass(frozen=True, slots=True)
class Word:
    """What one motion, or the machine, may do.

    Args:
        per_mille: of full speed, 0 to 1000.
        level: number in `LEVELS`; 0 if and only if the speed is 0.
        reason: number of a `Reason`.
        held: only while a person holds on.
        escapes: it leads out of contact.

    Raises:
        InputError: a number outside its range.
    """

    per_mille: int
    level: int
    reason: int
    held: bool = False
    escapes: bool = False

    def __post_init__(self) -> None:
        fits = 0 <= self.per_mille <= 1000 and 0 <= self.level < len(LEVELS) and 0 <= self.reason <= 0xFF
        if not fits or (self.level == 0) != (self.per_mille == 0):
            raise InputError(f"word: {self.per_mille} per mille, level {self.level}, reason {self.reason}")

    @classmethod
    def stop(cls, reason: int) -> "Word":
        """Nothing may move."""
        return cls(0, 0, reason)

    @property
    def flags(self) -> int:
        """As a number: 1 held, 2 escapes."""
        return HELD * self.held + ESCAPES * self.escapes


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """One finished pass.

    Args:
        sequence: its number; it rises.
        finished_ns: when it was finished [ns of `time.monotonic_ns`, one clock for all processes of this computer].
        deadline_ns: within which the next one follows; two missed are silence [ns].
        phase: of the gate, number in `PHASES`.
        machine: what may be done whatever moves.
        motions: what each motion may do.
        held_until_ns: until when words that are `held` count [ns]; 0: none is.
        trips_known: how many trips of the watchdog the gate knew of.
    """

    sequence: int
    finished_ns: int
    deadline_ns: int
    phase: int
    machine: Word
    motions: tuple[Word, ...]
    held_until_ns: int = 0
    trips_known: int = 0

    @property
    def is_last(self) -> bool:
        """Whether the run has ended as it was asked to."""
        return PHASES[self.phase] == "ended"

    def packed(self) -> bytes:
        """As bytes, with their length before them."""
        head = _HEAD.pack(
            MAGIC,
            VERSION,
            len(self.motions),
            self.sequence,
            self.finished_ns,
            self.deadline_ns,
            self.held_until_ns,
            self.trips_known,
            self.phase,
        )
        words = b"".join(
            _WORD.pack(word.per_mille, word.reason, word.level, word.flags)
            for word in (self.machine, *self.motions)
        )
        body = head + words
        return LENGTH.pack(len(body) + _CHECKSUM.size) + body + _CHECKSUM.pack(zlib.crc32(body))

    @classmethod
    def unpacked(cls, data: bytes) -> "Heartbeat":
        """From bytes, without their length.

        Raises:
            InputError: not what `packed` makes.
        """
        body, end = data[: -_CHECKSUM.size], data[-_CHECKSUM.size :]
        if len(body) < _HEAD.size or end != _CHECKSUM.pack(zlib.crc32(body)):
            raise InputError("heartbeat: wrong length or checksum")
        magic, version, count, sequence, finished, deadline, held, trips, phase = _HEAD.unpack_from(body)
        if magic != MAGIC or version != VERSION or len(body) != _HEAD.size + (count + 1) * _WORD.size:
            raise InputError(f"heartbeat: {magic!r} of version {version} with {count} motions")
        if phase >= len(PHASES):
            raise InputError(f"heartbeat: phase {phase}")
        machine, *motions = [
            Word(per_mille, level, reason, bool(flags & HELD), bool(flags & ESCAPES))
            for per_mille, reason, level, flags in _WORD.iter_unpack(body[_HEAD.size :])
        ]
        return cls(sequence, finished, deadline, phase, machine, tuple(motions), held, trips)
