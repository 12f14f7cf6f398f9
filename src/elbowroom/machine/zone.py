"""Zones of the room that a person declares: kept out, or not watched."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.machine.link import Surface
from elbowroom.machine.names import is_named
from elbowroom.machine.sizes import LARGEST_MESH_M, require_metres

ZoneKind = Literal["kept_out", "not_watched"]
ROUNDING_M = 1e-6
"""A corner of a voxel may stand out of a zone by this and lie in it [m]."""
CONVEX_SHARE = 0.99
"""A mesh whose volume is less than this share of its convex hull's is not convex."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Zone:
    """A convex volume of the room, by a person's word.

    *Kept out*: blocked for all links, always. *Not watched*: for some links alone, what nobody saw there is free; what
    any camera disputes there, or would if it delivered, is blocked for them as everywhere.

    Args:
        name: what verdicts and summaries call it.
        kind: "kept_out" or "not_watched".
        corners: those of the volume, shape (n, 3), world frame [m]: it is their convex hull.
        planes: the half-spaces that it lies in, shape (m, 4): unit normals that point outwards, and offsets [m].
        links: of "not_watched", names of the links, with wildcards ("*").
        reason: why, as every summary says it.

    Raises:
        MachineError: no name or reason, links where none belong or none where some do.
    """

    name: str
    kind: ZoneKind
    corners: NDArray[np.float64]
    planes: NDArray[np.float64]
    links: tuple[str, ...] = ()
    reason: str = ""

    def __post_init__(self) -> None:
        what = f"zones: {self.name or 'without a name'}"
        if not self.name:
            raise MachineError(f"{what}: verdicts name it; give it a name")
        if self.kind == "kept_out" and self.links:
            raise MachineError(f"{what}: kept out for all links; leave out links")
        if self.kind == "not_watched" and not self.links:
            raise MachineError(f"{what}: not watched for named links only; name them")
        if self.kind == "not_watched" and not self.reason:
            raise MachineError(f"{what}: not watched for a reason; every summary says it: give one")
        for array in (self.corners, self.planes):
            array.setflags(write=False)

    @classmethod
    def box(
        cls,
        name: str,
        kind: ZoneKind,
        lower_m: ArrayLike,
        upper_m: ArrayLike,
        links: Sequence[str] = (),
        reason: str = "",
    ) -> Self:
        """A box along the world's axes.

        Args:
            name, kind, links, reason: as of the class.
            lower_m, upper_m: its corners, shape (3,) [m].

        Raises:
            MachineError: a box without an inside, or as the class.
        """
        lower, upper = (np.array(corner, dtype=np.float64) for corner in (lower_m, upper_m))
        if lower.shape != (3,) or upper.shape != (3,) or not np.isfinite([lower, upper]).all():
            raise MachineError(f"zones: {name}: corners must be three finite numbers each [m]")
        if not (lower < upper).all():
            raise MachineError(
                f"zones: {name}: the box from {lower.tolist()} to {upper.tolist()} m has no inside; lower_m is its "
                "least corner, upper_m its greatest"
            )
        corners = np.array(np.meshgrid(*zip(lower, upper, strict=True))).reshape(3, -1).T
        normals = np.vstack([np.eye(3), -np.eye(3)])
        planes = np.column_stack([normals, np.concatenate([-upper, lower])])
        return cls(name, kind, corners, planes, tuple(links), reason)

    @classmethod
    def mesh(
        cls, name: str, kind: ZoneKind, surface: Surface, links: Sequence[str] = (), reason: str = ""
    ) -> Self:
        """A convex mesh.

        Args:
            name, kind, links, reason: as of the class.
            surface: its triangles, world frame [m].

        Raises:
            MachineError: a mesh that is not convex, open or flat, or as the class.
        """
        from scipy.spatial import ConvexHull, QhullError  # slow to load, and most sites have none

        used = surface.vertices[np.unique(surface.faces)]
        try:
            hull = ConvexHull(used)
        except (QhullError, ValueError):
            raise MachineError(f"zones: {name}: the mesh has no inside") from None
        a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
        volume = abs(float((a * np.cross(b, c)).sum())) / 6
        if volume < CONVEX_SHARE * hull.volume:
            raise MachineError(
                f"zones: {name}: the mesh is not convex, or open: it holds {volume:.3g} m3, its hull "
                f"{hull.volume:.3g}; cut it into convex zones"
            )
        return cls(name, kind, used[hull.vertices].copy(), hull.equations.copy(), tuple(links), reason)

    @classmethod
    def from_mesh_file(
        cls, name: str, kind: ZoneKind, path: Path, links: Sequence[str] = (), reason: str = ""
    ) -> Self:
        """A convex mesh from a file, world frame, in metres.

        Args:
            name, kind, links, reason: as of the class.
            path: of a kind that links may have.

        Raises:
            MachineError: a file that is missing, unreadable or not in metres, or as `mesh`.
        """
        # what reads meshes is slow to load, and most machines carry none
        from elbowroom.machine.mesh_file import read_mesh

        if not path.is_file():
            raise MachineError(f"zones: {name}: {path}: no such file; expected a mesh")
        read = read_mesh(path)
        require_metres(f"zones: {name}: {path}", read.vertices, LARGEST_MESH_M)
        return cls.mesh(name, kind, Surface(read.vertices, read.faces.astype(np.int32)), links, reason)

    def names(self, link: str) -> bool:
        """Whether the zone is not watched for a link; names may hold wildcards ("*")."""
        return any(is_named(link, name) for name in self.links)

    def has(self, points_in_world: NDArray[np.float64], beyond_m: float = 0.0) -> NDArray[np.bool_]:
        """Whether points lie in it, or no farther out of any of its planes than a distance.

        Args:
            points_in_world: shape (..., 3) [m].
            beyond_m: the distance [m].
        """
        out = points_in_world @ self.planes[:, :3].T + self.planes[:, 3]
        return np.asarray((out <= beyond_m + ROUNDING_M).all(axis=-1))

    @property
    def extent_m(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its least and greatest corner, shape (3,) each [m]."""
        return self.corners.min(axis=0), self.corners.max(axis=0)

    def __str__(self) -> str:
        lower, upper = ("(" + ", ".join(f"{value:.4g}" for value in corner) + ")" for corner in self.extent_m)
        why = f" ({self.reason})" if self.reason else ""
        if self.kind == "kept_out":
            return f"Kept out of, by the site's word: {self.name}, {lower} to {upper} m{why}"
        return f"Not watched for {', '.join(self.links)}, by the site's word: {self.name}, {lower} to {upper} m{why}"
