"""Values and arrays as one compressed text within an HTML file; `browser/report.js` reads it."""

import base64
import json
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(slots=True, eq=False)
class Pack:
    """Arrays, each known by its number."""

    _parts: list[bytes] = field(default_factory=list, init=False)
    _said: list[list[Any]] = field(default_factory=list, init=False)
    _at: int = field(default=0, init=False)

    def add(self, array: NDArray[Any]) -> int:
        """Keeps an array; its number.

        Args:
            array: of float32, int16, uint16 or uint32.
        """
        content = np.ascontiguousarray(array).tobytes()
        self._said.append([array.dtype.name, self._at, int(array.size)])
        content += bytes(-len(content) % 4)
        self._parts.append(content)
        self._at += len(content)
        return len(self._said) - 1

    def text(self, values: dict[str, Any]) -> str:
        """All of it: a length, the values as JSON, the arrays; compressed (zlib), in base 64.

        Args:
            values: what JSON knows.
        """
        head = json.dumps(
            {**values, "arrays": self._said}, separators=(",", ":"), ensure_ascii=False
        ).encode()
        head += b" " * (-len(head) % 4)
        whole = b"".join([len(head).to_bytes(4, "little"), head, *self._parts])
        return base64.b64encode(zlib.compress(whole, 9)).decode()


def steps_of(index: NDArray[np.int32], shape: tuple[int, int, int]) -> NDArray[np.uint32]:
    """Voxels as steps from one to the next in their order, which compress well.

    Args:
        index: shape (n, 3).
        shape: of the grid.
    """
    numbers = np.sort((index[:, 0].astype(np.int64) * shape[1] + index[:, 1]) * shape[2] + index[:, 2])
    return np.diff(numbers, prepend=0).astype(np.uint32)
