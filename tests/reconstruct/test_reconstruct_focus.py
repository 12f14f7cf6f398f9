import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame

GRID = VoxelGrid((-0.8, -0.6, 0.5), (32, 24, 20), 0.05)
CAMERA = DepthCamera("one", 64, 48, np.eye(4), Intrinsics(40, 40, 31.5, 23.5))


def a_frame():
    depth = np.full((48, 64), 1.4, dtype=np.float32)
    depth[20:30, 25:40] = 0.9
    return DepthFrame("one", 0, depth)


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
def test_in_focus_all_is_as_ever_and_out_of_focus_nothing_is_free(detail):
    focus = np.zeros(bits.word_count(GRID), dtype=bool)
    focus[::2] = True
    everywhere = reconstruct(GRID, [CAMERA], [a_frame()], detail=detail)
    focused = reconstruct(GRID, [CAMERA], [a_frame()], detail=detail, focus=focus)
    for name in ("free_words", "surface_words", "blind_words", "disputed_words"):
        assert (getattr(focused, name)[focus] == getattr(everywhere, name)[focus]).all()
    assert not focused.free_words[~focus].any() and focused.free_words.any()
    assert everywhere.free_words[~focus].any()
