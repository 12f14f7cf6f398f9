"""The site file of a bag: what the bag says, and beside it, marked, what it does not say."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.sources.bags.site_of import MILLIMETRE_M, SiteOf

NOISE = "realsense_d435"
"""The noisiest of the presets beyond two metres."""
VOXEL_M, COARSE_M = 0.05, 0.1
MOST_VOXELS = 20_000_000


def site_text(found: SiteOf, bag: Path, out: Path) -> str:
    """The site file, with comments.

    Args:
        found: what the bag says.
        bag: its place.
        out: where the file will be.
    """
    low, high = found.box
    many = float(np.prod((high - low) / VOXEL_M)) > MOST_VOXELS
    lines = [
        f"# {bag.name}: written by `elbowroom site from-bag`. What the bag does not say is marked: not in the bag.",
        "# Lengths in metres; cameras in OpenCV's axes (x right, y down, z forward), which ROS calls optical.",
        *(f"# note: {note}" for note in found.notes),
        f"name: {_quoted(bag.stem)}",
        "",
        "grid:                          # not in the bag: a box around the cameras and what they see at first",
        f"  origin_m: {_numbers(low)}",
        f"  upper_m: {_numbers(high)}",
        f"  voxel_size_m: {COARSE_M if many else VOXEL_M}",
        "",
        "camera_defaults:",
        "  depth_kind: planar           # of ROS: along the optical axis (REP 118)",
        f"  depth_scale_m: {MILLIMETRE_M}         # of 16UC1, which is in millimetres (REP 118); 32FC1 is in metres",
        "  # not in the bag, a careful guess: kinect_v1, azure_kinect, realsense_d455, tof, exact, or coefficients",
        f"  noise: {NOISE}",
        "  # min_depth_m: 0.3           # not in the bag: outside this range the sensor gives no return",
        "  # max_depth_m: 6.0",
        "",
        f"cameras:                       # places in {found.world}, by /tf_static",
        *(line for camera in found.cameras for line in _camera_lines(camera, found.said[camera.name])),
        "",
        *_machine_lines(found),
        "rule: three",
        "detail: pixel",
        "margin: {sigmas: 3.0, bias_m: 0.01, lateral_px: 0.5}   # not in the bag: what calibration leaves open",
        "max_frame_age_ms: 200          # not in the bag: older frames free nothing",
        "",
        "recording:",
        "  layout: bag",
        f"  file: {_quoted(os.path.relpath(bag.absolute(), out.absolute().parent))}",
        "  topics:",
        *(f"    {_quoted(name)}: {_quoted(topic.name)}" for name, topic in found.topics.items()),
    ]
    if found.joints:
        lines.append(f"  joint_topics: [{', '.join(map(_quoted, found.joints))}]")
    return "\n".join(
        [*lines, "  max_skew_ms: 50              # images farther apart than this make no moment", ""]
    )


def _camera_lines(camera: DepthCamera, said: Sequence[str]) -> list[str]:
    k = camera.intrinsics
    lines = [
        f"  - name: {_quoted(camera.name)}",
        *(f"    # {text}" for text in said),
        f"    width: {camera.width}",
        f"    height: {camera.height}",
        *(f"    {key}: {float(getattr(k, key))!r}" for key in ("fx", "fy", "cx", "cy")),
    ]
    if k.distortion:
        lines.append(f"    distortion: {list(k.distortion)}")
    rows = camera.world_from_camera.tolist()
    return [*lines, "    world_from_camera:", *(f"      - {row}" for row in rows)]


def _machine_lines(found: SiteOf) -> list[str]:
    """What there is to say of a machine, in comments."""
    if not found.joints:
        return ["# no machine: the bag has no topic of joints (sensor_msgs/msg/JointState)", ""]
    told = [f"#   {topic}: {', '.join(names) or 'no position'}" for topic, names in found.joints.items()]
    return [
        "# machine:                     # not in the bag: without it free space is seen and no motion is judged",
        "#   urdf: robot.urdf",
        *_base_lines(found),
        "# joints:                      # full speed, and the time to brake from it, of each joint; the bag has",
        *told,
        "#   JOINT: {max_speed_deg_s: 12, braking_time_s: 0.5}",
        "",
    ]


def _base_lines(found: SiteOf) -> list[str]:
    """Where the machine may stand: at each frame that is called a base."""
    if not found.bases:
        return [f"#   world_from_base: {np.eye(4).astype(int).tolist()}   # in {found.world}"]
    poses = {name: np.round(pose, 9) + 0.0 for name, pose in found.bases.items()}
    return [f"#   world_from_base: {pose.tolist()}   # of {name}, by tf" for name, pose in poses.items()]


def _numbers(values: NDArray[np.float64]) -> str:
    return "[" + ", ".join(f"{value + 0.0:.1f}" for value in values) + "]"


def _quoted(text: str) -> str:
    """A text as YAML has it: quoted where it could be read as something else."""
    plain = text.replace("/", "").replace("_", "").replace("-", "").replace(".", "")
    is_plain = (plain.isalnum() and text[0].isalpha()) or text.startswith(("/", "../"))
    words = {"yes", "no", "true", "false", "null", "on", "off", "y", "n"}
    if (
        is_plain
        and text.isascii()
        and text.lower() not in words
        and all(c.isalnum() or c in "/_-." for c in text)
    ):
        return text
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
