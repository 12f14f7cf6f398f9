"""All that decides what a snapshot comes to, as one value that a recording holds."""

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
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.motion import Motion, Override
from elbowroom.reconstruct import Terms
from elbowroom.sources import Room
from elbowroom.wire.mcap_writer import Attached

CONFIGURATION, SITE = "configuration.json", "site.yaml"
"""Names of the files within a recording."""
FORMAT = 1
"""Of recordings; a later one is refused."""


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """What stays the same throughout a run.

    Args:
        grid, cameras, machine, terms: of the room, as the run had them.
        motions: that are asked; none: what is free is seen, and no motion judged.
        override: as of `Cycle`.
        told: what is said of the run beside that: site, version, processor, threads.
        site_text: the site file, as it was.
    """

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    machine: Machine | None
    motions: tuple[Motion, ...]
    terms: Terms
    override: Override | None
    told: Mapping[str, Any] = field(default_factory=dict)
    site_text: bytes = b""

    @classmethod
    def of(cls, room: Room) -> Self:
        """Of a room that is watched."""
        machine, motions, override = room.machine, tuple[Motion, ...](), None
        if room.unasked is None:
            machine, motions = room.machine_and_motions()
            override = room.site.override(machine)
        text = _site_text(room.site.path)
        told = {
            "site": room.site.name,
            "site_sha256": hashlib.sha256(text).hexdigest(),
            "threads": thread_count(),
            "allowances": list(room.allowances),
            **meta(),
        }
        return cls(room.grid, room.cameras, machine, motions, room.terms, override, told, text)

    def cycle(self, keeps_images: bool = False) -> Cycle | SpaceCycle:
        """The pass that judges by it; no time goes by in it, since when it was judged is not judged again.

        Args:
            keeps_images: as of `Cycle`.
        """
        if not self.motions or self.machine is None:
            return SpaceCycle(self.grid, self.cameras, self.machine, self.terms, clock_ns=_no_time)
        return Cycle(
            self.grid,
            self.cameras,
            self.machine,
            self.motions,
            self.terms,
            keeps_images=keeps_images,
            clock_ns=_no_time,
            override=self.override,
        )

    def attached(self) -> list[Attached]:
        """As files within a recording."""
        values = (self.grid, self.cameras, self.machine, self.motions, self.terms, self.override)
        said = {"format": FORMAT, "told": self.told, "values": kept_values.kept(values)}
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
            BagError: malformed, or of a later version.
        """
        what = f"{what}: {CONFIGURATION}"
        try:
            said = json.loads(content)
            number, told, given = said["format"], said["told"], said["values"]
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise BagError(f"{what}: malformed ({error})") from None
        if number != FORMAT:
            raise BagError(f"{what}: of format {number}, this version reads format {FORMAT}")
        values = kept_values.read(json.dumps(given), what)
        if not (isinstance(values, tuple) and len(values) == 6 and isinstance(told, dict)):
            raise BagError(f"{what}: malformed")
        found = cls(*values, told, site_text)
        found._require_kinds(what)
        return found

    def _require_kinds(self, what: str) -> None:
        sound = (
            isinstance(self.grid, VoxelGrid)
            and isinstance(self.cameras, tuple)
            and all(isinstance(camera, DepthCamera) for camera in self.cameras)
            and isinstance(self.machine, Machine | None)
            and isinstance(self.motions, tuple)
            and all(isinstance(motion, Motion) for motion in self.motions)
            and isinstance(self.terms, Terms)
            and isinstance(self.override, Override | None)
        )
        if not sound:
            raise BagError(f"{what}: malformed: not the values that it should hold")


def _no_time() -> int:
    return 0


def _site_text(path: Path) -> bytes:
    """The site file; empty where it is gone."""
    try:
        return path.read_bytes()
    except OSError:
        return b""
