"""Velocities beside positions in a record of joints."""

import numpy as np
import pytest

from elbowroom.errors import JointsError
from elbowroom.sensing import JointRecord


def test_columns_of_velocities_are_no_joints_and_are_known_between_rows(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text("stamp_ns,long,larm,larm_velocity,other_velocity\n0,0,0,0.1,7\n1000,0.2,0.1,0.3,7\n")
    record = JointRecord.from_csv(path)
    assert record.joints == ("long", "larm", "other_velocity")
    assert record.velocities_at(500) == pytest.approx({"larm": 0.2})


@pytest.mark.parametrize("values", ([0.0], [0.0, np.nan]))
def test_velocities_that_are_none_are_refused(values):
    with pytest.raises(JointsError, match="joint record: larm"):
        JointRecord(np.array([0, 1]), {"larm": np.zeros(2)}, None, {"larm": np.array(values)})
