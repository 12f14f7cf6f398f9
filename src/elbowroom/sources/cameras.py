"""The cameras of a site, wherever they come from."""

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site


def cameras_of(
    site: Site, count: int | None = None, resolution: tuple[int, int] | None = None
) -> tuple[DepthCamera, ...]:
    """The cameras that a site lists, or those that the simulator makes for it.

    Args:
        site: the file.
        count: how many the simulator makes; None: as the site says.
        resolution: width and height of their images [px]; None: as the site says.

    Raises:
        SiteError: a camera that none can be, or no cameras yet.
        InputError: a count or a resolution where cameras are not made.
    """
    given = "cameras" if count is not None else "resolution" if resolution is not None else None
    if site.simulated is None or site.lists_cameras:
        if given is not None:
            why = "is none" if site.simulated is None else "lists its cameras"
            raise InputError(
                f"{given}: for simulated rooms whose cameras are made, and {site.path} {why}; leave it out"
            )
        return site.cameras()
    from elbowroom.simulate import wall_cameras

    settings = site.simulated_cameras()
    if count is not None:
        settings["count"] = count
    if resolution is not None:
        settings["width"], settings["height"] = resolution
    return wall_cameras(**settings)
