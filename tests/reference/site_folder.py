"""Site files and images that tests write."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

WIDTH, HEIGHT = 8, 6
FACING_X = [[0, 0, 1, -1.0], [-1, 0, 0, 0.0], [0, -1, 0, 0.5], [0, 0, 0, 1]]


class SiteFolder:
    """A folder in which tests write site files and images."""

    def __init__(self, path):
        self.path = path

    def write(self, content, name="site.yaml"):
        """The path of a site file with this content: a mapping, or text as it is."""
        text = (
            content if isinstance(content, str) else yaml.safe_dump(json.loads(json.dumps(content)))
        )  # through JSON: no aliases
        (self.path / name).write_text(text)
        return self.path / name

    def image(self, name, raw=1000, size=(WIDTH, HEIGHT)):
        """A 16-bit PNG whose pixels all hold one number."""
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(np.full(size[::-1], raw, dtype=np.uint16)).save(path)
        return path


@pytest.fixture
def folder(tmp_path):
    return SiteFolder(tmp_path)


@pytest.fixture
def plain():
    """The smallest site: two cameras, no machine."""
    pinhole = {"width": WIDTH, "height": HEIGHT, "fx": 8.0, "fy": 8.0, "cx": 3.5, "cy": 2.5}
    return {
        "grid": {"origin_m": [-1, -1, 0], "upper_m": [1, 1, 1], "voxel_size_m": 0.1},
        "camera_defaults": pinhole,
        "cameras": [
            {"name": "north", "world_from_camera": [list(row) for row in FACING_X]},
            {"name": "south", "position_m": [1, 0, 0.5], "look_at_m": [0, 0, 0.5]},
        ],
    }


@pytest.fixture
def arm_urdf(folder):
    """A machine of one turning and one sliding joint, with boxes for bodies."""
    link = '<link name="{}"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>'
    joint = (
        '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )
    text = '<robot name="arm">' + "".join(link.format(name) for name in ("base", "upper", "hand"))
    text += joint.format("turn", "revolute", "base", "upper") + joint.format(
        "slide", "prismatic", "upper", "hand"
    )
    path = Path(folder.path) / "arm.urdf"
    path.write_text(text + "</robot>")
    return path
