"""Whether anything was seen that stands in the grid, and who vouches for the depths where nothing was."""

from collections.abc import Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.contradiction.findings import COMPARED
from elbowroom.reconstruct.contradiction.views import Views
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.values import thinned
from elbowroom.sensing.values.nothing import nothing_ends_in


def nothing_seen(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    margin: Margin | None = None,
    found: Sequence[Finding] = (),
) -> tuple[Finding, ...]:
    """A stop where all of the grid reads free, nothing ends in it, and no two cameras agree on what lies behind it.

    A box in mid-air before far walls is right input, and looks like a wrong unit. Cameras that measure the same walls
    at the same places vouch for unit and poses: in another unit they would not.

    Args:
        grid: the watched box.
        cameras: of the room.
        frames: at most one of each, of its camera's size.
        margin: of cameras without one of their own; None: `Margin()`.
        found: before; where that stops, nothing is looked at.
    """
    by_name = {camera.name: camera for camera in cameras}
    if any(finding.stops for finding in found):
        return ()
    images = [thinned(by_name[frame.camera], frame) for frame in frames if frame.camera in by_name]
    nothing = nothing_ends_in(grid, images)
    if nothing is None:
        return ()
    pairs = Views.of(cameras, frames, margin or Margin()).pairs
    return (nothing,) if pairs.agrees.sum() < COMPARED else ()
