"""What a site file says of the gate: where its latch lies, how fast speed rises, who may poll."""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from elbowroom.site.entry import Entry, Number, Text, Whole
from elbowroom.site.paths import expand
from elbowroom.site.ranges import SECONDS, between


class ModbusEntry(Entry):
    """A Modbus TCP server that a PLC polls; reading is all it allows."""

    host: Text = "127.0.0.1"
    port: Annotated[Whole, Field(ge=1, le=65535)] = 5020

    @property
    def is_open(self) -> bool:
        """Whether other computers can read it."""
        return self.host not in ("127.0.0.1", "::1", "localhost")


class GateEntry(Entry):
    """The gate of a run: what verdicts and faults become for whoever drives the machine."""

    folder: Text | None = None
    deadline_ms: Annotated[Number, between(5, 10_000, "ms", SECONDS)] = 250.0
    rise_per_s: Annotated[Number, Field(gt=0, le=100)] = 0.5
    low_speed: Annotated[Number, Field(gt=0, le=0.5)] = 0.1
    hold_ms: Annotated[Number, Field(ge=20, le=200)] = 200.0
    modbus: ModbusEntry | None = None

    def folder_path(self, beside: Path) -> Path | None:
        """Where the latch lies; None: the file does not say.

        Args:
            beside: the site file's folder.
        """
        return None if self.folder is None else expand(self.folder, beside)
