"""What is found in the values of a site: its cameras' lenses and places, and the images of some moments."""

from collections.abc import Iterable, Mapping, Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.reconstruct.contradiction.findings import with_contradictions
from elbowroom.reconstruct.nothing_seen import nothing_seen
from elbowroom.sensing.never import Never
from elbowroom.sensing.values import look_at_images, look_at_setting
from elbowroom.sensing.values.scatter import look_at_scatter
from elbowroom.site import Site
from elbowroom.site.plausible import look_at_site
from elbowroom.site.recording_entry import SevenScenes
from elbowroom.sources.cameras import cameras_of
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.layouts.layout import layout_of

MOMENTS = 3
"""So many moments of a recording are read: the first, the last, and those evenly between."""
DARK = 0.1
"""Where so much of an image never returns, from its border on, that is told."""


def looked_at(site: Site) -> tuple[Finding, ...]:
    """What is found in a site and its recording; nothing is carved.

    Images are read that `moments` would read, of a few moments; none of a recording that is not there yet.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    grid, cameras = site.grid(), cameras_of(site)
    found = [*look_at_setting(grid, cameras), *look_at_site(site)]
    is_there = site.entry.recording is not None and site.missing_recording is None
    if is_there and not any(finding.stops for finding in found):
        for group in _some(layout_of(site).moments()):
            frames = [image.read() for image in group]
            units_m = {image.camera.name: image.unit_m for image in group}
            of_values = look_at_images(grid, cameras, frames, units_m)
            found += with_contradictions(cameras, frames, site.margin(), of_values)
            found += nothing_seen(grid, cameras, frames, site.margin(), found)
            found += look_at_scatter(cameras, frames, site.margin())
    return once(found)


def dark_note(site: Site) -> str | None:
    """Which cameras have a part of the image that never returns, in the moments that are looked at; None: none has.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    if site.entry.recording is None or site.missing_recording is not None:
        return None
    if isinstance(site.entry.recording, SevenScenes):
        # each frame is a camera of its own, and none looks twice
        return None
    found: dict[str, Never] = {}
    for group in _some(layout_of(site).moments()):
        for image in group:
            if image.camera.mask is None:
                found.setdefault(image.camera.name, Never(image.camera)).add(image.read())
    dark = {name: float(never.mask()[0].mean()) for name, never in found.items()}
    many = {name: share for name, share in dark.items() if share >= DARK}
    if not many:
        return None
    shares = ", ".join(f"{name} {share:.0%}" for name, share in many.items())
    return (
        f"a part of the image never returns, and disputes what other cameras see through: {shares}. If nothing can be "
        f"there that is not seen (dark corners, walls beyond the range): elbowroom site mask {site.path} --out masks"
    )


def units_of(site: Site, cameras: Sequence[DepthCamera]) -> Mapping[str, float]:
    """Metres per unit of a recording's images, by camera; of none where there is no recording.

    Args:
        site: of the cameras.
        cameras: whose units are asked for.
    """
    if site.entry.recording is None:
        return {}
    return {
        camera.name: site.depth_scale_m(camera.name)
        for camera in cameras
        if site.depth_bias_m(camera.name) == 0
    }


def once(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The first finding of each kind about the same cameras."""
    kept: dict[tuple[str, tuple[str, ...], bool], Finding] = {}
    for finding in findings:
        kept.setdefault((finding.kind, finding.about, finding.stops), finding)
    return tuple(kept.values())


def _some(groups: Sequence[list[Image]]) -> list[list[Image]]:
    last = len(groups) - 1
    return [groups[at] for at in sorted({round(last * n / (MOMENTS - 1)) for n in range(MOMENTS)}) if groups]
