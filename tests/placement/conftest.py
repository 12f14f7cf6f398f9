import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid
from reference.placement_rooms import camera_at


@pytest.fixture
def grid():
    return VoxelGrid((-2.0, -2.0, 0.0), (16, 16, 10), 0.25)


@pytest.fixture
def ring():
    """Seven cameras about the room, at two heights."""
    angles = np.arange(7) * 2 * np.pi / 7 + 0.1
    return [
        camera_at(f"c{n}", (2.3 * np.cos(a), 2.3 * np.sin(a), (2.4, 1.7)[n % 2]), (0.0, 0.0, 1.0))
        for n, a in enumerate(angles)
    ]
