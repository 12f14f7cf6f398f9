"""The links of a machine wherever they are: what is made of them is made once, at whatever place the machine stands."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from threading import RLock
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.parallel import spread
from elbowroom.machine.link import Link
from elbowroom.machine.simplify import BOUNDS_M, coarser

FINE_TRIANGLES = 20_000
"""A machine of more is drawn and swept with fewer; one of no more as it is."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The links of a machine, parents first. Machines of the same links share one: `Shape.of`.

    Args:
        links: as of the machine.
    """

    links: tuple[Link, ...]

    @classmethod
    def of(cls, links: Sequence[Link]) -> "Shape":
        """The shape of some links: always the same one, as long as anybody holds it."""
        key = tuple(map(id, links))
        with _lock:
            found = _shapes.get(key)
            if found is None:
                found = _shapes[key] = cls(tuple(links))
        return found

    @cached_property
    def is_fine(self) -> bool:
        """Whether it has more triangles than a voxel or a pixel needs."""
        return sum(len(link.faces) for link in self.links) > FINE_TRIANGLES

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """Of each link's surface, shape (n_links,) [m^2]."""
        corners = [np.moveaxis(link.triangles, 1, 0) for link in self.links]
        return np.array([np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 for a, b, c in corners])

    @cached_property
    def digest(self) -> bytes:
        """A check sum of all links' triangles."""
        digest = hashlib.sha256()
        for link in self.links:
            for array in (link.vertices, link.faces):
                digest.update(len(array).to_bytes(8, "little") + array.tobytes())
        return digest.digest()

    def bound(self, most_m: float) -> float:
        """How far the surfaces of `within(most_m)` may lie from the links' own: `most_m` or less, 0 if not fine [m]."""
        return max((bound for bound in BOUNDS_M if bound <= most_m and self.is_fine), default=0.0)

    def within(self, most_m: float) -> tuple[Link, ...]:
        """The links with as few triangles as may be; of a machine that is not fine, as they are.

        Args:
            most_m: how far a surface may lie from the link's own [m]; it does by `bound(most_m)` at most.
        """
        bound = self.bound(most_m)
        if bound == 0:
            return self.links
        return tuple(steps[min(1 + BOUNDS_M.index(bound), len(steps) - 1)] for steps in self._coarser)

    @cached_property
    def _coarser(self) -> list[tuple[Link, ...]]:
        return spread(coarser, self.links)


_shapes: WeakValueDictionary[tuple[int, ...], Shape] = WeakValueDictionary()
_lock = RLock()
