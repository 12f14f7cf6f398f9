"""A look at the machine's model: whether it is larger than what cameras see of the machine."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
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
        """Warnings about links; they stop nothing, since what is seen in the model does."""
        if self.found is None and snapshot.joints is not None and snapshot.frames:
            self.found = model_findings(self.machine, self.cameras, snapshot)
        return self.found or ()
