"""Where cameras may be mounted, which sensors there are and what they cost, as a site file describes it."""

from typing import Annotated

from pydantic import Field, model_validator

from elbowroom.site.camera_entry import CameraSettings
from elbowroom.site.entry import Count, Entry, Flag, NotNegative, Number, Point, Positive, Text
from elbowroom.site.ranges import MILLIMETRES, up_to
from elbowroom.site.room_entry import BoxEntry

Angle = Annotated[Number, Field(ge=0, le=180)]


class SensorEntry(CameraSettings):
    """A kind of sensor that may be bought; what is left out is as in `camera_defaults`."""

    name: Annotated[Text, Field(pattern=r"^[^/\\]+$", max_length=60)]
    price: NotNegative = 1.0


class MountEntry(Entry):
    """One place where a camera may be mounted, or where one hangs already.

    `price` and `cable_m` go before what `prices` says. A mount that is `taken` by something else is left out.
    """

    name: Annotated[Text, Field(pattern=r"^[^/\\]+$", max_length=60)]
    position_m: Point
    price: NotNegative | None = None
    cable_m: NotNegative | None = None
    taken: Flag = False


class AlongEntry(Entry):
    """Mounts at equal distances along the walls at some heights, on the ceiling, and on the room's mesh."""

    wall_spacing_m: Annotated[Positive, up_to(50, "m", MILLIMETRES)] | None = None
    heights_m: tuple[Annotated[Number, up_to(100, "m", MILLIMETRES)], ...] = (2.4, 0.4)
    ceiling_spacing_m: Annotated[Positive, up_to(50, "m", MILLIMETRES)] | None = None
    mesh_count: Count | None = None

    @model_validator(mode="after")
    def _says_something(self) -> "AlongEntry":
        if self.wall_spacing_m is None and self.ceiling_spacing_m is None and self.mesh_count is None:
            raise ValueError("at least one of wall_spacing_m, ceiling_spacing_m and mesh_count")
        if not self.heights_m:
            raise ValueError("at least one height")
        return self


class PricesEntry(Entry):
    """What a mount costs and a metre of cable, which runs along the room's axes to `hub_m`."""

    mount: NotNegative = 0.0
    cable_per_m: NotNegative = 0.0
    hub_m: Point | None = None

    @model_validator(mode="after")
    def _where_cables_end(self) -> "PricesEntry":
        if self.cable_per_m > 0 and self.hub_m is None:
            raise ValueError("hub_m, where the cables end, with cable_per_m")
        return self


class PlacementEntry(Entry):
    """All that `elbowroom placement` asks of a site besides its room and cameras."""

    views: Count = 3
    angle_deg: Angle = 100.0
    sensors: tuple[SensorEntry, ...] = ()
    mounts: tuple[MountEntry, ...] = ()
    mounts_along: AlongEntry | None = None
    forbidden: tuple[BoxEntry, ...] = ()
    aims_m: tuple[Point, ...] = ()
    prices: PricesEntry = PricesEntry()

    @model_validator(mode="after")
    def _own_names(self) -> "PlacementEntry":
        for what, names in (
            ("sensor", [sensor.name for sensor in self.sensors]),
            ("mount", [mount.name for mount in self.mounts]),
        ):
            doubled = sorted({name for name in names if names.count(name) > 1})
            if doubled:
                raise ValueError(
                    f"each {what} a name of its own; {', '.join(doubled)} is there more than once"
                )
        return self
