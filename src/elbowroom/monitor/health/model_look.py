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
    """Looks at the first moment that says where the machine is, and says again what it found then.

    Cameras may begin one after the other: while nothing stops, it looks again at twice as many, and once at all.

    Args:
        cameras: of the room.
        machine: whose model.
        is_absent: somebody vouches that it is in none of the images.
    """

    cameras: Sequence[DepthCamera]
    machine: Machine
    is_absent: bool = False
    name: str = "model"
    found: tuple[Finding, ...] | None = field(default=None, init=False)
    _looked: int = field(default=0, init=False)
    """At how many cameras it looked last."""

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """That the machine is elsewhere, which stops; else warnings about links, which stop nothing."""
        many = len({frame.camera for frame in snapshot.frames})
        if snapshot.joints is not None and self._is_due(many):
            self._looked = many
            there = machine_there(self.machine, self.cameras, snapshot, is_absent=self.is_absent)
            is_over = self.is_absent or any(finding.stops for finding in there)
            self.found = there if is_over else (*there, *model_findings(self.machine, self.cameras, snapshot))
        return self.found or ()

    def _is_due(self, many: int) -> bool:
        """Whether so many cameras say more than was seen before."""
        if any(finding.stops for finding in self.found or ()):
            return False
        return many > self._looked and (many >= 2 * self._looked or many == len(self.cameras))
