"""Whether masks are of the images that they mask."""

from collections.abc import Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.sensing.frame import DepthFrame

RETURNS = 0.3
"""Where a larger share of its masked pixels returns, a mask is of other images: people before far walls are less."""


def masked_returns(cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame]) -> tuple[Finding, ...]:
    """Masks under which many pixels return: flipped, of another camera, or of a time when something stood there.

    Args:
        cameras: of the room.
        frames: at most one of each, of its camera's size.
    """
    given, findings = {frame.camera: frame.depth_m for frame in frames}, []
    for camera in cameras:
        if camera.mask is None or camera.name not in given:
            continue
        depth = given[camera.name][camera.mask]
        share = float(((depth > 0) & (depth >= camera.min_depth_m) & (depth <= camera.deepest_m)).mean())
        if share > RETURNS:
            text = (
                f"{camera.name}: {100 * share:.0f} % of the pixels under its mask return; the mask is of "
                "other images, flipped, or out of date: elbowroom site mask makes it anew"
            )
            findings.append(Finding("mask", (camera.name,), text, False))
    return tuple(findings)
