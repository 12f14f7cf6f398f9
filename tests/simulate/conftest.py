import pytest

from elbowroom.geometry import VoxelGrid
from elbowroom.simulate import InterventionRoom


@pytest.fixture(scope="session")
def room():
    return InterventionRoom()


@pytest.fixture(scope="session")
def grid():
    return VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05)
