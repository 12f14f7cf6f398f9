"""A small room for faults: eight cameras with noise in a bare box of walls, and a box that slides to and fro."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.files.atomic import whole_file
from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.reference_file import save_references
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.site import Site

LOWER_M, UPPER_M = (-2.2, -2.0, 0.0), (2.2, 2.0, 2.6)
"""Corners of the room."""
HALF_M = 0.08
"""Half the edge of the box that slides."""
MIDDLE_M = (0.0, 0.0, 1.0)
SIGMA_M, TRUE_SIGMA_M = 0.004, 0.002
"""Noise as the site says it, and as it is."""
WIDTH, HEIGHT = 64, 48
AWAY_M, PERIOD_S = 0.05, 3.0
"""How far the box slides, and how long to and fro takes."""
PLACES = {
    "cam0": (-2.1, -1.9, 2.3),
    "cam1": (2.1, -1.9, 2.1),
    "cam2": (2.1, 1.9, 2.4),
    "cam3": (-2.1, 1.9, 0.5),
    "cam4": (0.0, -1.9, 1.3),
    "cam5": (2.1, 0.1, 1.0),
    "cam6": (-2.1, -0.2, 1.4),
    "cam7": (0.1, 1.9, 1.2),
}
URDF = f"""<robot name="slider">
  <link name="base"/>
  <link name="box">
    <collision><geometry><box size="{2 * HALF_M} {2 * HALF_M} {2 * HALF_M}"/></geometry></collision>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="box"/><axis xyz="1 0 0"/>
    <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/>
  </joint>
</robot>
"""
SPEED_M_S, BRAKING_S = 0.3, 0.2


def site_text(port: int | None, deadline_ms: float) -> str:
    """The site file.

    Args:
        port: of the Modbus server; None: there is none.
        deadline_ms: of the gate.
    """
    cameras = "\n".join(
        f"  - {{name: {name}, position_m: {list(place)}, look_at_m: {list(MIDDLE_M)}}}"
        for name, place in PLACES.items()
    )
    modbus = "" if port is None else f", modbus: {{port: {port}}}"
    return f"""name: room for faults
grid: {{origin_m: [-1, -1, 0.2], upper_m: [1, 1, 1.8], voxel_size_m: 0.1}}
camera_defaults: {{width: {WIDTH}, height: {HEIGHT}, fx: {WIDTH / 2}, fy: {WIDTH / 2}, cx: {WIDTH / 2 - 0.5},
  cy: {HEIGHT / 2 - 0.5}, noise: {{constant_m: {SIGMA_M}}}}}
cameras:
{cameras}
machine:
  urdf: slider.urdf
  world_from_base: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, {MIDDLE_M[2]}], [0, 0, 0, 1]]
joints: {{slide: {{max_speed_m_s: {SPEED_M_S}, braking_time_s: {BRAKING_S}}}}}
max_frame_age_ms: 250
watch: {{reference: reference.npz}}
gate: {{deadline_ms: {deadline_ms}, rise_per_s: 20{modbus}}}
"""


def written_site(folder: Path, port: int | None, deadline_ms: float) -> Path:
    """Writes the site file, its machine and what its cameras were commissioned on.

    Args:
        folder: that is there.
        port, deadline_ms: as of `site_text`.

    Returns:
        The site file.
    """
    (folder / "slider.urdf").write_text(URDF, encoding="utf-8")
    path = folder / "site.yaml"
    path.write_text(site_text(port, deadline_ms), encoding="utf-8")
    site, random = Site.load(path), np.random.default_rng(1)
    cameras, machine = site.cameras(), site.machine()
    commissioning = Commissioning(cameras, machine, 8)
    for number in range(8):
        joints = {"slide": at_s(number * 0.37)[0]}
        frames = tuple(DepthFrame(c.name, number, image_of(c, joints["slide"], random)) for c in cameras)
        commissioning.add(Snapshot(frames, joints, now_ns=number))
    with whole_file(folder / "reference.npz") as unfinished:
        save_references(commissioning.references(), unfinished)
    return path


def at_s(time_s: float) -> tuple[float, float]:
    """Where the box is at a time [m], and how fast it slides [m/s]."""
    turn = 2 * math.pi * time_s / PERIOD_S
    return AWAY_M * math.sin(turn), AWAY_M * 2 * math.pi / PERIOD_S * math.cos(turn)


def image_of(camera: DepthCamera, slide_m: float, random: np.random.Generator) -> NDArray[np.float32]:
    """What a camera measures, with noise, shape (height, width) [m].

    Args:
        camera: where it truly is.
        slide_m: where the box is.
        random: of the noise.
    """
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], 1.0), axis=-1)
    ways = rays @ camera.world_from_camera[:3, :3].T  # per metre of planar depth
    ways = np.where(np.abs(ways) < 1e-9, 1e-9, ways)
    centre = camera.world_from_camera[:3, 3]
    walls = np.where(ways > 0, UPPER_M, LOWER_M)
    depth = ((walls - centre) / ways).min(axis=-1)
    middle = np.array(MIDDLE_M) + (slide_m, 0, 0)
    ends = np.stack([(middle - HALF_M - centre) / ways, (middle + HALF_M - centre) / ways])
    entry, leave = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
    depth = np.where((entry < leave) & (entry > 0), np.minimum(entry, depth), depth)
    return (depth + random.normal(size=depth.shape) * TRUE_SIGMA_M).astype(np.float32)
