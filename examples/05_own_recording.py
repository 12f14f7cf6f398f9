"""Your own recording: 16-bit PNG images in folders, one site file that says the rest, and free space moment by moment.

    python examples/05_own_recording.py

The images are made here; yours lie in the same way: recording/<camera>/<time in ns>.png.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import elbowroom as er
from elbowroom.sources import moments

SITE = """\
name: my room
grid: {origin_m: [-1.5, -1.5, 0], upper_m: [1.5, 1.5, 2], voxel_size_m: 0.05}
camera_defaults:
  width: 160
  height: 120
  fx: 80
  fy: 80
  cx: 79.5
  cy: 59.5
  depth_scale_m: 0.001          # what one unit of the images is: here a millimetre
  max_depth_m: 6
cameras:
  - {name: north, position_m: [1.4, 0, 1.9], look_at_m: [0, 0, 0.5]}
  - {name: south, position_m: [-1.4, 0, 1.9], look_at_m: [0, 0, 0.5]}
  - {name: west, position_m: [0, 1.4, 1.9], look_at_m: [0, 0, 0.5]}
recording: {layout: folder, folder: recording, max_skew_ms: 20}
"""


def floor_image(camera: er.DepthCamera) -> np.ndarray:
    """Planar depth of an empty floor, in millimetres, shape (height, width)."""
    k = camera.intrinsics
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)
    down = (rays @ camera.world_from_camera[:3, :3].T)[..., 2]
    with np.errstate(divide="ignore"):
        depth_m = np.where(down < 0, -camera.centre_in_world[2] / down, 0.0)
    return np.where(depth_m < 6, 1000 * depth_m, 0).astype(np.uint16)


path = Path("my_room.yaml")
path.write_text(SITE)
site = er.Site.load(path)
for camera in site.cameras():
    folder = Path("recording") / camera.name
    folder.mkdir(parents=True, exist_ok=True)
    for stamp_ns in (0, 100_000_000):
        Image.fromarray(floor_image(camera)).save(folder / f"{stamp_ns}.png")

for moment in moments(site):
    space = er.reconstruct(site.grid(), site.cameras(), moment.frames, margin=site.margin())
    print(f"{moment.now_ns / 1e6:5.0f} ms: {len(moment.frames)} images, {100 * space.free.mean():.1f} % free")

print("the same from the command line: elbowroom site check my_room.yaml --out my_room.png")
