"""A look at the machine's model: whether the machine is where it is said to be, and as large as cameras see it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.reconstruct.machine_there import machine_there
from elbowroom.reconstruct.model_findings import model_findings
from elbowroom.sensing import Snapshot


@dataclass(slots=True, eq=False)
class ModelLook:
    """Looks once, at the first moment that says where the machine is; what it found then it says again.

    Args:
        cameras: of the room.
        machine: whose model.
    """

    cameras: Sequence[DepthCamera]
    machine: Machine
    name: str = "model"
    found: tuple[Finding, ...] | None = field(default=None, init=False)

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """That the machine is elsewhere, which stops; else warnings about links, which stop nothing."""
        if self.found is None and snapshot.joints is not None and snapshot.frames:
            there = machine_there(self.machine, self.cameras, snapshot)
            stops = any(finding.stops for finding in there)
            self.found = there if stops else (*there, *model_findings(self.machine, self.cameras, snapshot))
        return self.found or ()
