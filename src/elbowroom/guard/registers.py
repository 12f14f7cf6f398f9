"""What a PLC reads: 16-bit registers, of which the last one is a checksum over all before.

| register | holds |
|---|---|
| 0 | 0xEB01: the layout, version 1 |
| 1, 2 | sequence of the last finished pass, high word first; it rises with each pass |
| 3 | how long ago that was [ms], at most 65535 |
| 4 | phase: 0 never, 1 starting, 2 guarding, 3 latched, 4 cleared, 5 ended, 6 silent |
| 5 | level of the machine: 0 stop, 1 decelerate, 2 inform, 3 clear |
| 6 | speed of the machine, per mille of full speed |
| 7 | reason, the number of a `Reason` |
| 8 | number of motions n |
| 9 + 2 i | speed of motion i, per mille of full speed |
| 10 + 2 i | its level in bits 0 to 3, 1 in bit 4: only while held, 1 in bit 5: leads out, its reason in bits 8 to 15 |
| 9 + 2 n | CRC-16 as Modbus has it (polynomial 0xA001, start 0xFFFF) of the registers before, high byte first |
"""

from elbowroom.errors import InputError
from elbowroom.guard.watch import Said

LAYOUT = 0xEB01
HEAD = 9
MOST_IN_A_READ = 125
MOST_MOTIONS = (MOST_IN_A_READ - HEAD - 1) // 2


def register_count(motions: int) -> int:
    """How many registers there are.

    Args:
        motions: how many motions are asked.

    Raises:
        InputError: more than one request of Modbus can read at once.
    """
    if motions > MOST_MOTIONS:
        raise InputError(f"modbus: {motions} motions, at most {MOST_MOTIONS} can be read in one request")
    return HEAD + 2 * motions + 1


def registers(said: Said) -> list[int]:
    """All registers at one moment."""
    words = [
        LAYOUT,
        (said.sequence >> 16) & 0xFFFF,
        said.sequence & 0xFFFF,
        said.age_ms,
        said.phase,
        said.machine.level,
        said.machine.per_mille,
        said.machine.reason,
        len(said.motions),
    ]
    for word in said.motions:
        words += [word.per_mille, word.level | word.flags << 4 | word.reason << 8]
    return [*words, crc16(words)]


def crc16(words: list[int]) -> int:
    """CRC-16 as Modbus has it, over words with their high byte first."""
    crc = 0xFFFF
    for byte in b"".join(word.to_bytes(2, "big") for word in words):
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc
