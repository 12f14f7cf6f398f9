"""The packing of depth images, pixel by pixel, as its page says it."""

import struct

import numpy as np


def zigzag(more: int, bits: int) -> int:
    """0, -1, 1, -2, ... as 0, 1, 2, 3, ...; modulo 2**bits."""
    half = 1 << (bits - 1)
    more = (more + half) % (1 << bits) - half
    return 2 * more if more >= 0 else -2 * more - 1


def plain_zigzags(numbers: list[int], bits: int) -> list[int]:
    """What each number is more than the one before it."""
    return [zigzag(after - before, bits) for before, after in zip([0, *numbers], numbers, strict=False)]


def plain_codes(zigzags: list[int], is_half: bool) -> tuple[bytes, list[int]]:
    """One code a byte, or two; and what follows apart."""
    most = 15 if is_half else 255
    codes = [min(number, most) for number in zigzags]
    apart = [number for number in zigzags if number >= most]
    if not is_half:
        return bytes(codes), apart
    codes += [0] * (len(codes) % 2)
    return bytes(low | high << 4 for low, high in zip(codes[::2], codes[1::2], strict=True)), apart


def plain_rows(zigzags: list[int]) -> bytes:
    """Half a byte for each row of eight, and then their bits: those of a row stand in eight words of 16 abreast."""
    zigzags = zigzags + [0] * (-len(zigzags) % 8)
    rows = [zigzags[begin : begin + 8] for begin in range(0, len(zigzags), 8)]
    widths = [max(number.bit_length() for number in row) for row in rows]
    widths = [16 if width == 15 else width for width in widths]
    halves = [min(width, 15) for width in widths] + [0] * (len(rows) % 2)
    # all bits that one of the eight has written, the first row's lowest
    columns, length = [0] * 8, 0
    for row, width in zip(rows, widths, strict=True):
        columns = [column | number << length for column, number in zip(columns, row, strict=True)]
        length += width
    words = [column >> 16 * at & 0xFFFF for at in range(-(-length // 16)) for column in columns]
    begin = bytes(low | high << 4 for low, high in zip(halves[::2], halves[1::2], strict=True))
    return begin + struct.pack(f"<{len(words)}H", *words)


def plain_content(depth_m: np.ndarray, units: np.ndarray | None, is_half: bool) -> bytes:
    """What is compressed: of units, or of the bits of floats."""
    if units is not None:
        codes, apart = plain_codes(plain_zigzags([int(unit) for unit in units.ravel()], 16), is_half)
        return codes + bytes(number & 255 for number in apart) + bytes(number >> 8 for number in apart)
    bits = [struct.unpack("<I", struct.pack("<f", value))[0] for value in depth_m.ravel().tolist()]
    found = plain_zigzags(bits, 32)
    return bytes(number >> (8 * plane) & 255 for plane in range(4) for number in found)
