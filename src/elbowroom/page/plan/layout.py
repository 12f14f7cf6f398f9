"""All that can be moved while planning, as one value: cameras, the machine's joints, people, things."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, looking_at
from elbowroom.simulate.person import Person, Stance, Walk
from elbowroom.simulate.solid import Mesh, Solid

NOWHERE = Walk((0.0, 0.0), (0.1, 0.1), 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class PlacedCamera:
    """A camera where it hangs.

    Args:
        camera: with its name and pose.
        sensor: the name of its kind.
    """

    camera: DepthCamera
    sensor: str

    @property
    def name(self) -> str:
        """Of the camera."""
        return self.camera.name

    def at(self, world_from_camera: NDArray[np.float64]) -> "PlacedCamera":
        """The same camera elsewhere, shape (4, 4)."""
        return replace(self, camera=replace(self.camera, world_from_camera=world_from_camera))

    def looking(self, at_m: tuple[float, float, float]) -> "PlacedCamera":
        """The same camera, turned so that it looks at a point, upright.

        Args:
            at_m: the point, world frame [m].

        Raises:
            CameraError: the point is where it hangs.
        """
        return self.at(looking_at(self.camera.centre_in_world.tolist(), at_m))


@dataclass(frozen=True, slots=True)
class PlacedPerson:
    """Somebody who stands.

    Args:
        name: such as "person 1".
        x_m, y_m: on the floor, world frame [m].
        heading_rad: about z from the x axis [rad].
        height_m: of the body [m].
    """

    name: str
    x_m: float
    y_m: float
    heading_rad: float = 0.0
    height_m: float = 1.75

    def solids(self, floor_m: float) -> tuple[Solid, ...]:
        """Body and hair, on a floor [m]."""
        person = Person(self.name, NOWHERE, self.height_m, 0.9)
        lift = np.eye(4)
        lift[2, 3] = floor_m
        stance = Stance(self.x_m, self.y_m, self.heading_rad)
        return tuple(replace(s, world_from_solid=lift @ s.world_from_solid) for s in person.solids(stance))


@dataclass(frozen=True, slots=True, eq=False)
class PlacedThing:
    """Furniture, of the package or of a file.

    Args:
        name: of this one.
        kind: of the furniture, or the file that it came from.
        parts: its solids about its own origin, which stands on the floor; those that are not closed have no inside.
        x_m, y_m, z_m: where its origin is, world frame [m].
        turn_rad: about z [rad].
    """

    name: str
    kind: str
    parts: tuple[Solid, ...]
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    turn_rad: float = 0.0

    @property
    def world_from_thing(self) -> NDArray[np.float64]:
        """Its pose, shape (4, 4)."""
        c, s = math.cos(self.turn_rad), math.sin(self.turn_rad)
        return np.array([[c, -s, 0, self.x_m], [s, c, 0, self.y_m], [0, 0, 1, self.z_m], [0, 0, 0, 1.0]])

    def solids(self) -> tuple[Solid, ...]:
        """Its solids where it stands; they never move."""
        pose, made = self.world_from_thing, []
        for part in self.parts:
            corners = part.vertices_in_world @ pose[:3, :3].T + pose[:3, 3]
            name = self.name if len(self.parts) == 1 else f"{self.name}: {part.name}"
            mesh = Mesh(corners, part.mesh.faces)
            made.append(
                Solid(name, mesh, np.eye(4), is_static=True, is_dark=part.is_dark, has_inside=part.has_inside)
            )
        return tuple(made)


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Where everything is.

    Args:
        cameras, people, things: each with a name of its own among its like.
        joints: of the machine, by name [m or rad]; empty without one.
    """

    cameras: tuple[PlacedCamera, ...] = ()
    joints: Mapping[str, float] = field(default_factory=dict)
    people: tuple[PlacedPerson, ...] = ()
    things: tuple[PlacedThing, ...] = ()

    @property
    def bodies(self) -> "tuple[PlacedPerson | PlacedThing, ...]":
        """People and things: what stands on the floor."""
        return (*self.people, *self.things)

    @property
    def camera_names(self) -> tuple[str, ...]:
        """Of all cameras."""
        return tuple(placed.name for placed in self.cameras)

    @property
    def body_names(self) -> tuple[str, ...]:
        """Of all people and things."""
        return tuple(body.name for body in self.bodies)

    def camera(self, name: str) -> PlacedCamera:
        """One by its name.

        Raises:
            InputError: there is none.
        """
        return _of(self.cameras, name, "camera")

    def person(self, name: str) -> PlacedPerson:
        """One by its name.

        Raises:
            InputError: there is none.
        """
        return _of(self.people, name, "person")

    def thing(self, name: str) -> PlacedThing:
        """One by its name.

        Raises:
            InputError: there is none.
        """
        return _of(self.things, name, "thing")

    def having(self, one: PlacedCamera | PlacedPerson | PlacedThing) -> "Layout":
        """The same with one more, or in place of the one of its name."""
        if isinstance(one, PlacedCamera):
            return replace(self, cameras=_with(self.cameras, one))
        if isinstance(one, PlacedPerson):
            return replace(self, people=_with(self.people, one))
        return replace(self, things=_with(self.things, one))

    def without(self, one: PlacedCamera | PlacedPerson | PlacedThing) -> "Layout":
        """The same without one."""
        return replace(
            self,
            cameras=tuple(c for c in self.cameras if c is not one),
            people=tuple(p for p in self.people if p is not one),
            things=tuple(t for t in self.things if t is not one),
        )

    def free_name(self, stem: str, joint: str = " ") -> str:
        """A name that nothing here has yet, such as "person 3".

        Args:
            stem: what it begins with.
            joint: between it and the number.
        """
        taken = {*self.camera_names, *self.body_names}
        number = 1
        while f"{stem}{joint}{number}" in taken:
            number += 1
        return f"{stem}{joint}{number}"


class _HasName(Protocol):
    @property
    def name(self) -> str: ...


Named = TypeVar("Named", bound=_HasName)


def _of(some: tuple[Named, ...], name: str, what: str) -> Named:
    for one in some:
        if one.name == name:
            return one
    raise InputError(f"plan: there is no {what} {name!r}")


def _with(some: tuple[Named, ...], one: Named) -> tuple[Named, ...]:
    names = [each.name for each in some]
    if one.name not in names:
        return (*some, one)
    return tuple(one if each.name == one.name else each for each in some)
