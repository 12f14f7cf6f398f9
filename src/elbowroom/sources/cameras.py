"""The cameras of a site, wherever they come from, and as a run says otherwise."""

from dataclasses import replace

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.site import Site
from elbowroom.site.camera_entry import CameraSettings

EXACT = "exact"


def cameras_of(
    site: Site, count: int | None = None, resolution: tuple[int, int] | None = None
) -> tuple[DepthCamera, ...]:
    """The cameras that a site lists, or those that the simulator makes for it.

    Args:
        site: the file.
        count: how many the simulator makes; None: as the site says.
        resolution: width and height of simulated images [px]; None: as the site says.

    Raises:
        SiteError: a camera that none can be, or no cameras yet.
        InputError: a count where cameras are not made, or a resolution where they are not simulated.
    """
    _refuse(site, {"cameras": count, "resolution": resolution})
    if site.simulated is None or site.lists_cameras:
        cameras = site.cameras()
    else:
        from elbowroom.simulate import InterventionRoom, wall_cameras
        from elbowroom.simulate.inside import hung_clear

        settings = site.simulated_cameras()
        if count is not None:
            settings["count"] = count
        if resolution is not None:
            settings["width"], settings["height"] = resolution
        # those that would hang inside a cabinet hang beside it
        cameras = hung_clear(wall_cameras(**settings), InterventionRoom(people=False).solids)
    return cameras if resolution is None else tuple(with_size(camera, resolution) for camera in cameras)


def with_noise(site: Site, noise: str) -> Site:
    """A site all of whose cameras have the noise of a sensor, by its name.

    Args:
        site: the file.
        noise: "exact", or a preset.

    Raises:
        InputError: neither.
    """
    if noise != EXACT and noise not in NOISE_PRESETS:
        raise InputError(f"noise: {noise!r} is unknown, allowed are {', '.join([EXACT, *NOISE_PRESETS])}")
    said = CameraSettings.model_validate({"noise": noise}).noise
    entry = site.entry
    changed = {
        "camera_defaults": entry.camera_defaults.model_copy(update={"noise": said}),
        "cameras": tuple(camera.model_copy(update={"noise": said}) for camera in entry.cameras),
    }
    return Site(site.path, entry.model_copy(update=changed))


def with_size(camera: DepthCamera, size: tuple[int, int]) -> DepthCamera:
    """The same view in more or fewer pixels.

    Args:
        camera: any.
        size: width and height [px].
    """
    width, height = size
    if size == (camera.width, camera.height):
        return camera
    k, across, down = camera.intrinsics, width / camera.width, height / camera.height
    intrinsics = Intrinsics(
        fx=k.fx * across,
        fy=k.fy * down,
        cx=(k.cx + 0.5) * across - 0.5,
        cy=(k.cy + 0.5) * down - 0.5,
        distortion=k.distortion,
    )
    return replace(camera, width=width, height=height, intrinsics=intrinsics)


def _refuse(site: Site, given: dict[str, object]) -> None:
    """What a run may say of simulated cameras alone.

    Raises:
        InputError: it says so of others.
    """
    names = [name for name, value in given.items() if value is not None]
    if site.simulated is None and names:
        raise InputError(f"{names[0]}: for simulated rooms, and {site.path} is none; leave it out")
    if site.lists_cameras and "cameras" in names:
        raise InputError(
            f"cameras: for simulated rooms whose cameras are made, and {site.path} lists its cameras; leave it out"
        )
