"""Declared contact: a fixed thing of the room that some links may be near, and touch if somebody says so."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.link import Surface
from elbowroom.machine.names import is_named
from elbowroom.machine.sizes import LARGEST_MESH_M, require_metres

NEAR_M = 0.1
"""How near to a thing voxels are given to its links, where nothing else is said [m]."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Contact:
    """A thing that stands still, such as a table, a floor or a post, and the links that may be near it.

    What cameras see of it within their noise is the thing, for these links alone: they may come as near as what is
    measured leaves them. What stands out of it, such as a hand or a cup, blocks them as it does all others. They never
    go into the thing itself, unless they may touch it.

    Args:
        name: what verdicts and summaries call it.
        surface: its triangles, world frame [m].
        links: names of the links; they may hold wildcards ("*").
        near_m: farther from the thing nothing changes [m].
        zone: its least and greatest corner, shape (2, 3), world frame [m]: nothing changes outside; None: all about it.
        may_touch: whether links may go into the thing as it is declared: a wheel on the floor, a foot.

    Raises:
        MachineError: no name, no link, no triangles, or a distance or zone that cannot be.
    """

    name: str
    surface: Surface
    links: tuple[str, ...]
    near_m: float = NEAR_M
    zone: NDArray[np.float64] | None = None
    may_touch: bool = False

    def __post_init__(self) -> None:
        what = f"contacts: {self.name or 'without a name'}"
        if not self.name:
            raise MachineError(f"{what}: verdicts name it; give it a name")
        if not self.links:
            raise MachineError(f"{what}: no links; name those that may be near it")
        if not len(self.surface.faces) or not np.isfinite(self.surface.vertices).all():
            raise MachineError(f"{what}: has no triangles with finite corners")
        if not (np.isfinite(self.near_m) and self.near_m > 0):
            raise MachineError(f"{what}: near_m is {self.near_m}, must be above 0 [m]")
        if self.zone is not None:
            zone = np.array(self.zone, dtype=np.float64)
            if zone.shape != (2, 3) or not np.isfinite(zone).all() or not (zone[0] < zone[1]).all():
                raise MachineError(f"{what}: its zone has no inside; give its least and greatest corner [m]")
            zone.setflags(write=False)
            object.__setattr__(self, "zone", zone)
        object.__setattr__(self, "links", tuple(self.links))

    @classmethod
    def box(
        cls,
        name: str,
        links: Sequence[str],
        lower_m: ArrayLike,
        upper_m: ArrayLike,
        near_m: float = NEAR_M,
        zone: ArrayLike | None = None,
        may_touch: bool = False,
    ) -> Self:
        """A box along the world's axes.

        Args:
            name, links, near_m, zone, may_touch: as of the class.
            lower_m, upper_m: its corners, shape (3,) [m].

        Raises:
            MachineError: a box without an inside, or as the class.
        """
        from elbowroom.machine.meshes import solid_triangles  # slow to load, and most machines need none

        lower, upper = (np.array(corner, dtype=np.float64) for corner in (lower_m, upper_m))
        if lower.shape != (3,) or not np.isfinite([lower, upper]).all() or not (lower < upper).all():
            raise MachineError(
                f"contacts: {name}: the box from {lower.tolist()} to {upper.tolist()} m has no inside; lower_m is its "
                "least corner, upper_m its greatest"
            )
        vertices, faces = solid_triangles("box", (upper - lower).tolist())
        surface = Surface(vertices + (lower + upper) / 2, faces.astype(np.int32))
        given = None if zone is None else np.asarray(zone, dtype=np.float64)
        return cls(name, surface, tuple(links), near_m, given, may_touch)

    @classmethod
    def from_mesh_file(
        cls, name: str, links: Sequence[str], path: Path, pose: ArrayLike | None = None
    ) -> Self:
        """A mesh from a file, in metres.

        Args:
            name, links: as of the class.
            path: of a kind that links may have.
            pose: world_from_mesh, shape (4, 4), rigid; None: frames are one.

        Raises:
            MachineError: a file that is missing, unreadable or not in metres, or as the class.
        """
        # what reads meshes is slow to load, and most machines carry none
        from elbowroom.machine.mesh_file import read_mesh

        if not path.is_file():
            raise MachineError(f"contacts: {name}: {path}: no such file; expected a mesh")
        read = read_mesh(path)
        require_metres(f"contacts: {name}: {path}", read.vertices, LARGEST_MESH_M)
        given = np.eye(4) if pose is None else pose
        pose = nearest_rigid(given, f"contacts: {name}: world_from_mesh", MachineError)
        vertices = read.vertices @ pose[:3, :3].T + pose[:3, 3]
        return cls(name, Surface(vertices, read.faces.astype(np.int32)), tuple(links))

    def names(self, link: str) -> bool:
        """Whether a link may be near it; names may hold wildcards ("*")."""
        return any(is_named(link, name) for name in self.links)

    def is_near(self, points_in_world: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether points may lie where it changes anything: in the box that holds it, grown by `near_m`, and its zone.

        Args:
            points_in_world: shape (n, 3) [m].
        """
        least, greatest = self.extent_m
        lower, upper = least - self.near_m, greatest + self.near_m
        if self.zone is not None:
            lower, upper = np.maximum(lower, self.zone[0]), np.minimum(upper, self.zone[1])
        return np.asarray(((points_in_world >= lower) & (points_in_world <= upper)).all(axis=-1))

    @property
    def extent_m(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its least and greatest corner, shape (3,) each, world frame [m]."""
        corners = self.surface.vertices[np.unique(self.surface.faces)]
        return corners.min(axis=0), corners.max(axis=0)

    def __str__(self) -> str:
        lower, upper = ("(" + ", ".join(f"{value:.4g}" for value in corner) + ")" for corner in self.extent_m)
        may = "touch" if self.may_touch else "be near"
        return (
            f"May {may} {self.name}, {lower} to {upper} m, by the site's word: {', '.join(self.links)}, within "
            f"{1e3 * self.near_m:.0f} mm" + ("" if self.zone is None else ", in a part of it")
        )
