"""All looks at images, one after the other."""

from collections.abc import Mapping, Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.sensing.frame import DepthFrame
from elbowroom.sensing.values.amid import look_amid
from elbowroom.sensing.values.content import look_at_content
from elbowroom.sensing.values.inverse import look_at_inverses
from elbowroom.sensing.values.sentinel import look_at_sentinels
from elbowroom.sensing.values.thinned import Thinned, thinned
from elbowroom.sensing.values.together import together
from elbowroom.sensing.values.unit import look_at_units


def look_at_images(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    units_m: Mapping[str, float | None] | None = None,
) -> tuple[Finding, ...]:
    """What is found in the images of one moment: units, sentinels, masks, byte order, disparity, nothing at all.

    Args:
        grid: the watched box.
        cameras: of the room.
        frames: at most one of each camera, of its size.
        units_m: metres per unit of the files that they were read from, by camera; what is left out is not known.

    Returns:
        One finding for all cameras of which the same was found.
    """
    by_name = {camera.name: camera for camera in cameras}
    units = units_m or {}
    images = [
        thinned(by_name[frame.camera], frame, units.get(frame.camera))
        for frame in frames
        if frame.camera in by_name
    ]
    return together(found_in(images, grid), len(cameras))


def found_in(images: Sequence[Thinned], grid: VoxelGrid, *, of_all: bool = True) -> list[Finding]:
    """Each thing that is found, of one camera; what no unit or range can mend keeps the image from further looks.

    Args:
        images: one of each camera.
        grid: the watched box.
        of_all: these are all cameras of the room, at a first moment; else one that is asked again.
    """
    if not images:
        return []
    findings = look_at_content(images, of_all=of_all)
    if of_all:
        findings += look_at_inverses(_returning(_without(images, findings)))
    findings += look_at_sentinels(_returning(_without(images, findings)), grid)
    if not of_all:
        return findings
    findings += look_amid(_returning(_without(images, findings)), findings)
    return findings + look_at_units(_without(images, findings), grid)


def _without(images: Sequence[Thinned], findings: Sequence[Finding]) -> list[Thinned]:
    """The images of cameras of which nothing was found that stops."""
    stopped = {name for finding in findings if finding.stops for name in finding.about}
    return [image for image in images if image.camera.name not in stopped]


def _returning(images: Sequence[Thinned]) -> list[Thinned]:
    return [image for image in images if image.returns.any()]
