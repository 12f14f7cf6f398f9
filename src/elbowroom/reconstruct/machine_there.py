"""Whether the machine is where it is said to be, by the images of one moment; what would fit better, if anything."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.transforms import invert_rigid
from elbowroom.machine import Machine
from elbowroom.machine.elsewhere import LEAST_PIXELS, Elsewhere, elsewhere
from elbowroom.reconstruct.machine_images import machine_images
from elbowroom.sensing import Snapshot

KIND = "machine"
MUCH = 4
"""So many times the pixels of a link say that a machine is seen."""
MOST, MANY = 0.5, 0.1
"""Where so many of the pixels see through it, its base is doubted first; from the lesser share on it stops."""
FITS = 0.1
"""Another place of the base is named where so many of the pixels still see through the machine, at most."""


def machine_there(
    machine: Machine, cameras: Sequence[DepthCamera], snapshot: Snapshot, *, is_absent: bool = False
) -> tuple[Finding, ...]:
    """A finding where cameras see through links of the machine: a verdict would be on another machine.

    It stops where two cameras or more see through several links, or through all that they should see, or where all are
    seen with another base. One link may be of glass, was taken off, or is the hull of a frame that is mostly open: that
    is a warning.

    Args:
        machine: where it is said to be.
        cameras: of the room.
        snapshot: their frames, and where the joints were; without joints nothing is found.
        is_absent: somebody vouches that it is in none of the images; a warning if it is seen all the same.

    Raises:
        CameraError, FrameError: frames of other cameras or sizes.
        MachineError: joints that are not possible.
    """
    images = machine_images(cameras, snapshot)
    if images is None:
        return ()

    def seen_if(as_said: Machine) -> Elsewhere:
        return elsewhere(as_said, *images)

    found = seen_if(machine)
    if is_absent:
        return _seen_all_the_same(machine, found)
    if not found.links:
        return _unseen(machine, found) or _a_little(machine, found)
    better = _better(machine, found, seen_if)
    several = len(found.links) > 1 and found.share >= MANY
    stops = found.cameras > 1 and (several or bool(better) or found.links == found.shown)
    return (Finding(KIND, found.links, _text(machine, found, better), stops),)


def _seen_all_the_same(machine: Machine, found: Elsewhere) -> tuple[Finding, ...]:
    """That it stands where it is said to come, though somebody says that it is in no image."""
    if found.links or found.share >= MANY or found.agree < MUCH * LEAST_PIXELS:
        return ()
    text = (
        f"{machine.name} is seen where it is to stand by {1 - found.share:.0%} of {found.through + found.agree} "
        "pixels, or something of its shape: all of it is taken for something else, so that everything stops there. If "
        "it is the machine, leave recording.without_machine out"
    )
    return (Finding(KIND, (machine.name,), text, stops=False),)


def _unseen(machine: Machine, found: Elsewhere) -> tuple[Finding, ...]:
    """That no camera sees anything of the machine, so that nothing says whether it is there."""
    if found.agree + found.through >= LEAST_PIXELS:
        return ()
    text = (
        f"no camera sees anything of {machine.name} where it is said to be: nothing says that it is there. Check "
        "world_from_base and the world that camera poses are given in, or turn a camera to it"
    )
    return (Finding(KIND, (machine.name,), text, stops=False),)


def _a_little(machine: Machine, found: Elsewhere) -> tuple[Finding, ...]:
    """That a part of each link is seen through: something is off by a little."""
    if found.share < MANY:
        return ()
    text = (
        f"{found.share:.0%} of {found.through + found.agree} pixels see through {machine.name} where it is said to "
        "be: world_from_base, joints, or the cameras' poses or lenses (images that were cropped or scaled) are a "
        "little off, or its model is larger than it is"
    )
    return (Finding(KIND, (machine.name,), text, stops=False),)


def _text(machine: Machine, found: Elsewhere, better: str) -> str:
    links = f"link {found.links[0]}" if len(found.links) == 1 else f"links {', '.join(found.links)}"
    return (
        f"{links} of {machine.name}: cameras see through the place where it is said to be, {found.share:.0%} of "
        f"{found.through + found.agree} pixels through the machine: verdicts would be on a machine that stands "
        f"elsewhere. {better or _likely(found) + _or_never(found)}"
    )


def _or_never(found: Elsewhere) -> str:
    """The key for images in which it never stood, where next to nothing of it is seen."""
    if found.share < MOST:
        return ""
    return "; or, if the images are from before it was installed, the site says recording: {without_machine: true}"


def _likely(found: Elsewhere) -> str:
    """What to check where no other place of the base fits."""
    if found.shown[0] not in found.links and found.share < MOST:
        return (
            "Where the machine begins it is seen: check the joints' values, their order, unit, sign and zero, and at "
            "which time they were so; or what is mounted on it"
        )
    return (
        "Check world_from_base, the world that all camera poses are given in, and the joints' values, their order, "
        "unit and sign"
    )


def _better(machine: Machine, found: Elsewhere, seen_if: Callable[[Machine], Elsewhere]) -> str:
    """A place of the base at which all links are seen, in words; "": none of those that are tried."""
    for words, base in _other_bases(machine):
        other = seen_if(machine.at(base))
        if not other.links and other.share <= FITS and other.agree > found.agree:
            return f"With {words} {other.share:.0%} would: correct world_from_base, or give all poses in its world"
    return ""


def _other_bases(machine: Machine) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Places of the base that are often meant: in words, and shape (4, 4)."""
    base = machine.world_from_base
    for degrees in (90, 180, 270):
        angle, turn = np.radians(degrees), np.eye(4)
        turn[:2, :2] = ((np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle)))
        yield f"the base turned by {degrees} degrees about its z axis", base @ turn
    yield "the inverse of world_from_base", invert_rigid(base)
