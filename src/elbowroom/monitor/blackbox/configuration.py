"""All that decides what a snapshot comes to, as one value that a recording holds."""

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from elbowroom.errors import BagError
from elbowroom.files.json_rows import meta
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.parallel import thread_count
from elbowroom.machine import Machine
from elbowroom.monitor.blackbox import kept_values
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.separation.figures import Figures, figures_of
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.motion import Motion
from elbowroom.motion.separation import Separation
from elbowroom.reconstruct import Terms
from elbowroom.site.separation_entry import SeparationEntry
from elbowroom.sources import Room
from elbowroom.wire.mcap_writer import Attached

CONFIGURATION, SITE = "configuration.json", "site.yaml"
"""Names of the files within a recording."""
FORMAT = 2
"""Of recordings that are written; those before it are read, a later one is refused. 2: images may be rows of bits."""
OF_THE_RUN = ("clock_ns", "keeps_images")
"""What of a cycle does not change what a snapshot comes to."""


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """What stays the same throughout a run.

    Args:
        fields: of the cycle, by name; those of `Cycle`, or of `SpaceCycle` where no motion is asked.
        told: what is said of the run beside that: site, version, processor, threads, and the figures of its margins.
        site_text: the site file, as it was.
    """

    fields: Mapping[str, Any]
    told: Mapping[str, Any] = field(default_factory=dict)
    site_text: bytes = b""

    @classmethod
    def of(cls, room: Room, cycle: Cycle | SpaceCycle) -> Self:
        """Of a run.

        Args:
            room: that is watched.
            cycle: that judges.
        """
        text = _site_text(room.site.path)
        told = {
            "site": room.site.name,
            "site_sha256": hashlib.sha256(text).hexdigest(),
            "threads": thread_count(),
            "allowances": list(room.allowances),
            "separation": None if room.unasked is not None else _told_figures(figures_of(room)),
            **meta(),
        }
        return cls({name: getattr(cycle, name) for name in _names(type(cycle))}, told, text)

    @property
    def cameras(self) -> tuple[DepthCamera, ...]:
        """Of the room."""
        return tuple(self.fields["cameras"])

    @property
    def machine(self) -> Machine | None:
        """What moves."""
        machine: Machine | None = self.fields["machine"]
        return machine

    @property
    def motions(self) -> tuple[Motion, ...]:
        """That are asked; none: what is free is seen, and no motion judged."""
        return tuple(self.fields.get("motions", ()))

    def figures(self) -> Figures | None:
        """By which margins were said; None: nobody asked, or it is not told.

        Raises:
            BagError: malformed.
        """
        said = self.told.get("separation")
        if said is None:
            return None
        try:
            separation = kept_values.made_of(said["separation"], CONFIGURATION)
            entry = SeparationEntry(**said["entry"])
            if not isinstance(separation, Separation):
                raise TypeError("separation")
            return Figures(separation, float(said["look_m"]), entry, float(said["capability_m"]))
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise BagError(f"{CONFIGURATION}: malformed: separation ({type(error).__name__})") from None

    def cycle(self, keeps_images: bool = False) -> Cycle | SpaceCycle:
        """The pass that judges by it; no time goes by in it, since when it was judged is not judged again.

        Args:
            keeps_images: as of `Cycle`.
        """
        if not self.motions:
            return SpaceCycle(**self.fields, clock_ns=_no_time)
        return Cycle(**self.fields, keeps_images=keeps_images, clock_ns=_no_time)

    def attached(self) -> list[Attached]:
        """As files within a recording."""
        said = {"format": FORMAT, "told": self.told, "values": kept_values.kept(self.fields)}
        text = json.dumps(said, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
        return [
            Attached(SITE, "application/yaml", self.site_text),
            Attached(CONFIGURATION, "application/json", text.encode()),
        ]

    @classmethod
    def read(cls, content: bytes, site_text: bytes, what: str) -> Self:
        """The one that a recording holds.

        Args:
            content: of the file within it.
            site_text: of the other one.
            what: names the recording in errors.

        Raises:
            BagError: malformed, or of another version.
        """
        what = f"{what}: {CONFIGURATION}"
        said = kept_values.parsed(content, what)
        if not isinstance(said, dict) or not isinstance(said.get("told"), dict):
            raise BagError(f"{what}: malformed")
        if said.get("format") not in range(1, FORMAT + 1):
            raise BagError(
                f"{what}: of format {said.get('format')}, this version reads formats 1 to {FORMAT}"
            )
        fields = kept_values.made_of(said.get("values"), what)
        _require_sound(fields, what)
        return cls(fields, said["told"], site_text)


def _told_figures(figures: Figures) -> dict[str, Any]:
    """As `Configuration.figures` reads them."""
    return {
        "separation": kept_values.kept(figures.separation),
        "look_m": figures.look_m,
        "entry": figures.entry.model_dump(),
        "capability_m": figures.capability_m,
    }


def plain_cycle(room: Room) -> Cycle | SpaceCycle:
    """The cycle of a room, nothing asked that its site does not say."""
    if room.unasked is not None:
        return SpaceCycle(room.grid, room.cameras, room.machine, room.terms)
    machine, motions = room.machine_and_motions()
    site = room.site
    override, braking = site.override(machine), site.braking(machine)
    return Cycle(room.grid, room.cameras, machine, motions, room.terms, override=override, braking=braking)


def _require_sound(fields: Any, what: str) -> None:
    """Refuses what is not that of a cycle of this version.

    Raises:
        BagError: it is not.
    """
    if not isinstance(fields, dict):
        raise BagError(f"{what}: malformed: no values")
    kind = Cycle if fields.get("motions") else SpaceCycle
    unknown = [name for name in fields if name not in _names(kind)]
    kinds = {"grid": VoxelGrid, "cameras": tuple, "terms": Terms, "motions": tuple}
    wrong = [
        name for name, due in kinds.items() if name in _names(kind) and not isinstance(fields.get(name), due)
    ]
    wrong += (
        [] if all(isinstance(camera, DepthCamera) for camera in fields.get("cameras") or ()) else ["cameras"]
    )
    wrong += [] if all(isinstance(motion, Motion) for motion in fields.get("motions") or ()) else ["motions"]
    machine = fields.get("machine")
    if unknown or wrong or not isinstance(machine, Machine if kind is Cycle else Machine | None):
        raise BagError(f"{what}: malformed: {', '.join([*unknown, *wrong]) or 'machine'}")


def _names(kind: type[Cycle] | type[SpaceCycle]) -> tuple[str, ...]:
    """Fields of a cycle that are kept."""
    return tuple(each.name for each in dataclasses.fields(kind) if each.init and each.name not in OF_THE_RUN)


def _no_time() -> int:
    return 0


def _site_text(path: Path) -> bytes:
    """The site file; empty where it is gone."""
    try:
        return path.read_bytes()
    except OSError:
        return b""
