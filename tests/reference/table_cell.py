"""An arm on a table as a site file, small enough for tests: cameras near, or too far to tell the two apart."""

from pathlib import Path

import pytest
import yaml

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "arm_on_a_table"
POSE = "pan=55deg,lift=5deg,elbow=65deg,wrist_1=100deg,wrist_2=0,wrist_3=0"


def table_cell(folder: Path, far: bool = False, **changes) -> Path:
    """Writes the cell of the example with smaller images and larger voxels, and gives its path.

    Args:
        folder: where to.
        far: cameras at 2.3 m in the corners, and the arm so low that its shoulder all but touches the table.
        changes: other keys of the file; None leaves one out.
    """
    content = yaml.safe_load((EXAMPLE / "cell.yaml").read_text())
    content["camera_defaults"] |= {"width": 100, "height": 75, "fx": 60.5, "fy": 60.5, "cx": 49.5, "cy": 37.0}
    content["grid"]["voxel_size_m"] = 0.08
    content["machine"]["urdf"] = str(EXAMPLE / "arm.urdf")
    if far:
        content["grid"]["voxel_size_m"] = 0.04
        content["camera_defaults"] |= {
            "width": 200,
            "height": 150,
            "fx": 121.0,
            "fy": 121.0,
            "cx": 99.5,
            "cy": 74.5,
        }
        content["cameras"] = [
            camera | {"position_m": [x * 1.45 for x in camera["position_m"][:2]] + [2.3]}
            for camera in content["cameras"][:4]
        ]
        content["machine"]["world_from_base"][2][3] = 0.63
    content |= changes
    path = folder / "cell.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in content.items() if value is not None}))
    return path


@pytest.fixture
def cell(tmp_path):
    return table_cell(tmp_path)


@pytest.fixture
def far_cell(tmp_path):
    return table_cell(tmp_path, far=True)
