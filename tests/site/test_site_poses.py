"""A pose as position and quaternion is the pose that scipy and its matrix say."""

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.errors import InputError
from elbowroom.site import Site
from elbowroom.site.camera_entry import CameraEntry

TURN = [-0.334947, -0.808633, 0.446841, 0.185087]


def entry(**more):
    return CameraEntry.model_validate({"name": "a", "position_m": [1.8, 1.8, 2.4], **more})


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_a_quaternion_is_the_rotation_that_scipy_says_in_either_order(given_turn):
    x, y, z, w = np.array(given_turn) / np.linalg.norm(given_turn)
    expected = np.eye(4)
    expected[:3, :3], expected[:3, 3] = Rotation.from_quat([x, y, z, w]).as_matrix(), (1.8, 1.8, 2.4)
    for key, turn in (("quaternion_xyzw", (x, y, z, w)), ("quaternion_wxyz", (w, x, y, z))):
        np.testing.assert_allclose(entry(**{key: turn}).pose(None), expected, atol=1e-12)


def test_numbers_of_few_digits_are_a_rotation_and_other_lengths_are_refused():
    looks = entry(quaternion_xyzw=[round(v, 4) for v in TURN]).pose(None)[:3, 2]
    np.testing.assert_allclose(looks, [-0.598671, -0.598671, -0.532152], atol=1e-3)
    with pytest.raises(ValueError, match=r"quaternion_xyzw of length 1, a rotation; its length is 2"):
        entry(quaternion_xyzw=[2 * v for v in TURN])


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"quaternion_xyzw": TURN, "quaternion_wxyz": TURN},
        {"quaternion_xyzw": TURN, "look_at_m": [0, 0, 0]},
        {"quaternion_xyzw": TURN, "world_from_camera": np.eye(4).tolist()},
        {"quaternion_xyzw": TURN, "position_m": None},
    ],
)
def test_there_is_one_way_to_say_a_pose(more):
    with pytest.raises(
        ValueError, match="exactly one of world_from_camera, pose_file, or position_m with look_at_m"
    ):
        entry(**more)


def test_a_matrix_written_column_by_column_is_named_as_such(tmp_path):
    pose = np.eye(4)
    pose[:3, 3] = 1.0, 2.0, 0.5
    site = {
        "grid": {"origin_m": [-1, -1, 0], "upper_m": [1, 1, 2], "voxel_size_m": 0.1},
        "cameras": [
            {
                "name": "a",
                "world_from_camera": pose.T.tolist(),
                "width": 160,
                "height": 120,
                "fx": 80.0,
                "fy": 80.0,
                "cx": 79.5,
                "cy": 59.5,
            }
        ],
    }
    (tmp_path / "site.yaml").write_text(yaml.safe_dump(site))
    with pytest.raises(InputError, match="written column by column, transpose it"):
        Site.load(tmp_path / "site.yaml").cameras()
