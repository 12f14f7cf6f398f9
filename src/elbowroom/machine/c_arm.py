"""The ceiling C-arm that ships with the package: the thesis' example, with the movements of its Fig. 6."""

from pathlib import Path

from numpy.typing import ArrayLike

from elbowroom.machine.machine import Machine

CEILING_C_ARM_URDF: Path = Path(__file__).parent / "assets" / "ceiling_c_arm" / "ceiling_c_arm.urdf"
"""Its URDF; `assets/ceiling_c_arm/build.py` of the repository writes it and its meshes."""
UNCHECKED_LINKS = ("rail", "carriage")
"""They hang above the watched grid, under a ceiling at 2.9 m."""


def ceiling_c_arm(world_from_base: ArrayLike | None = None) -> Machine:
    """A ceiling-suspended C-arm in a room whose floor is z = 0.

    Joints: `long` (prismatic, the carriage along the rail in x, +-0.6 m), `larm` (the L-arm about the
    vertical through the isocentre, +-90 degrees), `propeller` (the C about the horizontal axis through column
    and isocentre, +-60 degrees), `carc` (the C along its own ring, +-45 degrees). At zero the isocentre is at
    (0, 0, 1.1) m, the column at x = -1.2 m, the head end of a table along x, and the C in the plane of x and
    z, open towards +x: detector above, source below. A table 0.5 m wide with its top at 0.95 m fits from x =
    -0.65 m on. Everything but rail and carriage stays in x, y = -2 to 2 m, z = 0.12 to 2.5 m for all joint
    positions.

    Args:
        world_from_base: where it hangs, shape (4, 4), rigid; None: as above.

    Raises:
        MachineError: `world_from_base` is not rigid.
    """
    return Machine.from_urdf(
        CEILING_C_ARM_URDF, world_from_base=world_from_base, unchecked_links=UNCHECKED_LINKS
    )
