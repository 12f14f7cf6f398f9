"""Margins that a site's cameras are written with once they are calibrated: the sensor's and the pose's together."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.margin import pose_margin
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin
from elbowroom.site import Site


def with_margins(
    site: Site,
    found: Sequence[CalibratedCamera],
    confidence: float,
    depth_errors: Mapping[str, tuple[float, float]] | None = None,
    *,
    near_m: float | None = None,
) -> list[DepthCamera]:
    """The cameras with margins of sensor and pose together.

    Args:
        site: whose sensor margins they are.
        found: poses and covariances.
        confidence: that nothing is displaced by more.
        depth_errors: bias [m] and scale by which a camera's depth was found to read wrong; a site file has no place to
            take them out, so they are allowed for.
        near_m: depth from which lateral margins hold [m]; None: as `pose_margin`.

    Raises:
        CalibrationError: a confidence or a depth that is none.
    """
    cameras = []
    for one in found:
        sensor = _sensor_margin(site, one.camera.name, (depth_errors or {}).get(one.camera.name, (0.0, 0.0)))
        pose = pose_margin(one.camera, one.covariance, confidence=confidence, near_m=near_m)
        cameras.append(replace(one.camera, margin=pose.over(sensor)))
    return cameras


def _sensor_margin(site: Site, name: str, depth_error: tuple[float, float]) -> Margin:
    listed = site.simulated is None or site.lists_cameras
    sensor = site.sensor_margin(name) if listed else site.margin()
    bias, scale = depth_error
    return replace(
        sensor,
        bias_m=max(sensor.bias_m, abs(bias)),
        range_linear=max(sensor.range_linear, abs(scale)),
    )
