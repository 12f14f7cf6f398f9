"""The cameras of a site, wherever they come from."""

from elbowroom.geometry import DepthCamera
from elbowroom.placement.requirement import Requirement
from elbowroom.simulate import wall_cameras
from elbowroom.site import Site


def cameras_of(site: Site) -> tuple[DepthCamera, ...]:
    """The cameras that a site lists, or those that the simulator makes for it.

    Raises:
        SiteError: a camera that none can be, or no cameras yet.
    """
    if site.simulated is None or site.lists_cameras:
        return site.cameras()
    return wall_cameras(**site.simulated_cameras())


def requirement_of(site: Site, views: int | None = None, angle_deg: float | None = None) -> Requirement:
    """The requirement of a site's key `placement`, or what is said otherwise.

    Args:
        site: the file.
        views, angle_deg: instead of the site's; None: the site's, or 3 and 100 degrees.

    Raises:
        InputError: a requirement that cannot be met on a circle.
    """
    given = site.entry.placement
    default = Requirement()
    if views is None:
        views = default.views if given is None else given.views
    if angle_deg is None:
        angle_deg = default.angle_deg if given is None else given.angle_deg
    return Requirement(views, angle_deg)
