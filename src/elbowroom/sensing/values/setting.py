"""All looks at what a site says of its cameras, before any image is seen."""

from collections.abc import Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.sensing.values.lens import look_at_lens
from elbowroom.sensing.values.place import look_at_places
from elbowroom.sensing.values.together import together


def look_at_setting(grid: VoxelGrid, cameras: Sequence[DepthCamera]) -> tuple[Finding, ...]:
    """Lenses that cannot be those of their images, and cameras that cannot hang where they are said to.

    Args:
        grid: the watched box.
        cameras: of the room.

    Returns:
        One finding for all cameras of which the same was found.
    """
    findings = [finding for camera in cameras for finding in look_at_lens(camera)]
    stopped = {name for finding in findings if finding.stops for name in finding.about}
    usable = [camera for camera in cameras if camera.name not in stopped]
    return together(findings + look_at_places(usable, grid), len(cameras))
