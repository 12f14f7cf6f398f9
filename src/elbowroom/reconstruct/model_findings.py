"""What is found out about the machine's model from images: links that are larger than what is seen of them."""

from collections.abc import Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.machine.excess import Excess, excess_of
from elbowroom.reconstruct.machine_images import machine_images
from elbowroom.sensing import Snapshot


def model_findings(
    machine: Machine, cameras: Sequence[DepthCamera], snapshot: Snapshot
) -> tuple[Finding, ...]:
    """A warning for each link whose model is larger than what is seen of it.

    Args:
        machine: whose model.
        cameras: of the room.
        snapshot: their frames, and where the machine was; without joints nothing is found.

    Raises:
        CameraError, FrameError: frames of other cameras or sizes.
        MachineError: joints that are not possible.
    """
    images = machine_images(cameras, snapshot)
    found = () if images is None else excess_of(machine, *images)
    return tuple(Finding("model", (excess.link,), _text(machine, excess), False) for excess in found)


def _text(machine: Machine, excess: Excess) -> str:
    link = machine.links[machine.link_names.index(excess.link)]
    geometry = "visual geometry, by which it is explained," if link.seen is not None else "collision geometry"
    mend = (
        "explain it by its collision geometry (machine: explain_with: collision) or mend the mesh"
        if link.seen is not None
        else "give it visual geometry that is its surface (machine: explain_with), or collision geometry that fits"
    )
    return (
        f"link {excess.link}: model {1e3 * excess.excess_m:.0f} mm larger than seen, in {100 * excess.share:.0f} % of "
        f"{excess.blocks} places: its {geometry} is larger than the machine, or something is in it; returns from "
        f"there stop it, as a hand's would: {mend}"
    )
