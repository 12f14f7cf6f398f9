import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.errors import CameraError, MachineError, PoseWarning
from elbowroom.geometry import invert_rigid, nearest_rigid

seeds = st.integers(0, 2**32 - 1)


def random_rigid(seed):
    random = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(rng=random).as_matrix()
    pose[:3, 3] = random.uniform(-5, 5, 3)
    return pose


@given(seed=seeds)
def test_inverse_undoes(seed):
    pose = random_rigid(seed)
    np.testing.assert_allclose(pose @ invert_rigid(pose), np.eye(4), atol=1e-12)


def test_many_are_inverted_at_once():
    poses = np.stack([random_rigid(1), random_rigid(2)]).reshape(2, 1, 4, 4)
    np.testing.assert_allclose(
        invert_rigid(poses) @ poses, np.broadcast_to(np.eye(4), (2, 1, 4, 4)), atol=1e-12
    )


@given(seed=seeds)
def test_a_rigid_pose_stays_as_it_is_without_a_word(seed):
    pose = random_rigid(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_allclose(nearest_rigid(pose, "pose"), pose, atol=1e-12)


@given(seed=seeds, size=st.floats(1e-5, 2e-4))
def test_a_pose_a_little_off_is_mended_and_said_so(seed, size):
    pose = random_rigid(seed)
    off = pose.copy()
    off[:3, :3] += np.random.default_rng(seed + 1).choice([-size, size], (3, 3)) * (1 + np.eye(3))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mended = nearest_rigid(off, "pose of north")
    np.testing.assert_allclose(mended[:3, :3] @ mended[:3, :3].T, np.eye(3), atol=1e-12)
    np.testing.assert_array_equal(mended[:3, 3], pose[:3, 3])
    assert np.abs(mended - pose).max() < 4 * size
    # a pure rotation may hide in the change: then nothing was off
    if caught:
        assert caught[0].category is PoseWarning and "pose of north" in str(caught[0].message)
    else:
        assert np.abs(off[:3, :3] - mended[:3, :3]).max() <= 1e-6


def test_scaling_a_little_is_said():
    pose = np.eye(4)
    pose[0, 0] = 1.0005
    with pytest.warns(PoseWarning, match=r"off a rotation by 5\.0e-04"):
        nearest_rigid(pose, "pose")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m.__setitem__((0, 0), 1.0011), "not rigid, off the nearest rotation by 0.0011"),
        (lambda m: m.__setitem__((0, 0), -1.0), "mirrors space"),
        (lambda m: m.__setitem__((0, 3), np.nan), "contains NaN"),
        (lambda m: m.__setitem__((1, 1), np.inf), "contains NaN or infinity"),
        (lambda m: m.__setitem__((3, 0), 0.1), "last row"),
        (lambda m: m.__setitem__((slice(0, 3), slice(0, 3)), 0.0), "not rigid"),
    ],
)
def test_what_is_no_pose_is_refused(change, message):
    pose = np.eye(4)
    change(pose)
    with pytest.raises(CameraError, match=message):
        nearest_rigid(pose, "pose")


def test_the_caller_names_the_error():
    with pytest.raises(MachineError, match=r"base: expected a 4x4 matrix, got shape \(3, 3\)"):
        nearest_rigid(np.eye(3), "base", MachineError)
