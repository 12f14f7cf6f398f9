"""What a run of the monitor watches, in words."""

from collections.abc import Sequence
from dataclasses import dataclass

from elbowroom.geometry import VoxelGrid
from elbowroom.sources import Room


@dataclass(frozen=True, slots=True)
class Watched:
    """What a run watches, for the head of the screen.

    Args:
        title: of the room or site.
        grid: the watched box.
        cameras: in words, such as "21 cameras 160x120".
        rule, detail: as of `reconstruct`.
        source: in words, where frames come from: its time is shown apart.
        unchecked_links: links of the machine that are not checked.
        bodiless_links: links of the machine that move without a body.
        allowances: what else the site lets pass, a line each.
    """

    title: str
    grid: VoxelGrid
    cameras: str
    rule: str
    detail: str
    source: str
    unchecked_links: Sequence[str] = ()
    bodiless_links: Sequence[str] = ()
    allowances: Sequence[str] = ()

    @property
    def room(self) -> str:
        """Grid, cameras and rule in one line."""
        size = " x ".join(f"{n * self.grid.voxel_size_m:.1f}" for n in self.grid.shape)
        voxels = f"{size} m in {self.grid.size:,} voxels of {self.grid.voxel_size_m * 100:g} cm"
        return f"{voxels}, {self.cameras}, rule {self.rule}, detail {self.detail}"


def watched_of(room: Room) -> Watched:
    """What the head of the screen says of a room."""
    sizes = sorted({f"{camera.width}x{camera.height}" for camera in room.cameras})
    cameras = f"{len(room.cameras)} camera{'s' * (len(room.cameras) > 1)} {', '.join(sizes)}"
    return Watched(
        title=room.site.name,
        grid=room.grid,
        cameras=cameras,
        rule=room.terms.rule,
        detail=room.terms.detail,
        source=room.source.name,
        unchecked_links=room.machine.unchecked_links if room.machine else (),
        bodiless_links=room.machine.bodiless_links if room.machine else (),
        allowances=room.allowances,
    )
