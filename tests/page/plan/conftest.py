from pathlib import Path

import pytest

from elbowroom.page.plan.ground import Ground
from elbowroom.site import Site

ROOM = """
name: small room
grid: {origin_m: [-1, -1, 0], upper_m: [1, 1, 2], voxel_size_m: 0.1}
room:
  walls: {lower_m: [-1.2, -1.2, 0], upper_m: [1.2, 1.2, 2.2]}
  furniture:
    - {name: shelf, lower_m: [0.6, 0.6, 0.0], upper_m: [1.0, 1.0, 1.6]}
camera_defaults: {width: 64, height: 48, fx: 32, fy: 32, cx: 31.5, cy: 23.5, max_depth_m: 5.0}
cameras:   # who hangs where
  - {name: a, position_m: [-1.1, -1.1, 1.9], look_at_m: [0, 0, 0.9]}
  - {name: b, position_m: [1.1, -1.1, 1.9], look_at_m: [0, 0, 0.9]}
  - {name: c, position_m: [-1.1, 1.1, 0.4], look_at_m: [0, 0, 0.9]}
  - {name: d, position_m: [1.1, 0.0, 1.9], look_at_m: [0, 0, 0.9]}
placement:
  views: 2
  angle_deg: 60
  sensors:
    - {name: small, price: 100}
    - {name: wide, price: 300, fx: 20, fy: 20, cx: 31.5, cy: 23.5}
  mounts:
    - {name: beam, position_m: [0.0, 0.0, 2.1], price: 7, cable_m: 3}
  prices: {mount: 10, cable_per_m: 2, hub_m: [1.2, 1.2, 2.2]}
"""


@pytest.fixture
def site(tmp_path: Path) -> Site:
    path = tmp_path / "room.yaml"
    path.write_text(ROOM, encoding="utf-8")
    return Site.load(path)


@pytest.fixture
def ground(site: Site) -> Ground:
    return Ground.of(site)
