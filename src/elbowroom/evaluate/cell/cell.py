"""A cell to be measured: its site with the machine's URDF found, its fixed room, its motions."""

from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from elbowroom.errors import InputError, PackageError
from elbowroom.extras import install_command
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.reconstruct import Terms
from elbowroom.site import Site
from elbowroom.sources.cameras import cameras_of

UR5_ON_A_TABLE = Path(__file__).with_name("ur5_on_a_table.yaml")
"""The cell that is measured unless another site is named."""
ROBOTS = "example-robot-data"
"""The package that the UR5's URDF comes with."""


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """All that a measurement needs of a site.

    Args:
        site: the file.
        grid, cameras, machine, terms: of the site.
        motions: those that are measured.
        room: what never moves there.
    """

    site: Site
    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    machine: Machine
    motions: tuple[Motion, ...]
    terms: Terms
    room: FixedRoom


def cell_of(path: Path | None = None, voxel_size_m: float | None = None) -> Cell:
    """The cell of a site file; None: the UR5 on a table.

    Args:
        path: of the site file.
        voxel_size_m: edge of a voxel [m]; None: the site's.

    Raises:
        PackageError: no site is named, and the package with the UR5 is not installed.
        InputError: a site without a machine, without speeds of its joints, or without a key `room`.
    """
    site = ur5_on_a_table() if path is None else Site.load(path)
    machine, room = site.machine(), FixedRoom.of_site(site)
    if machine is None or not site.motions(machine):
        raise InputError(f"{site.path}: a cell needs a machine, and speeds of its joints")
    if room is None or site.simulated is not None:
        raise InputError(
            f"{site.path}: room: missing; it says what stands in the cell, which is then known exactly"
        )
    grid = site.grid(voxel_size_m)
    return Cell(site, grid, cameras_of(site), machine, site.motions(machine), site.terms(), room)


def ur5_on_a_table() -> Site:
    """The site of the UR5, with its URDF as the package `example-robot-data` has it.

    Raises:
        PackageError: it is not installed.
    """
    site = Site.load(UR5_ON_A_TABLE)
    assert site.entry.machine is not None
    machine = site.entry.machine.model_copy(
        update={"urdf": str(published_urdf(str(site.entry.machine.urdf)))}
    )
    return Site(site.path, site.entry.model_copy(update={"machine": machine}))


def published_urdf(name: str) -> Path:
    """A URDF of the package `example-robot-data`, by its file's name.

    Raises:
        PackageError: the package is not installed, or has no such file.
    """
    try:
        package = metadata.distribution(ROBOTS)
    except metadata.PackageNotFoundError:
        raise PackageError(
            f"the cell's robot comes with {ROBOTS}, which is not installed: {install_command('evaluate')}"
        ) from None
    for file in package.files or ():
        if file.name == name:
            return Path(str(package.locate_file(file))).resolve()
    raise PackageError(f"{ROBOTS} {package.version} has no {name}")
