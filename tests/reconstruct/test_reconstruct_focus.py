import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame

GRID = VoxelGrid((-0.8, -0.6, 0.5), (32, 24, 20), 0.05)
CAMERA = DepthCamera("one", 64, 48, np.eye(4), Intrinsics(40, 40, 31.5, 23.5))


def a_frame():
    depth = np.full((48, 64), 1.4, dtype=np.float32)
    depth[20:30, 25:40] = 0.9
    return DepthFrame("one", 0, depth)


def test_out_of_focus_is_free_what_footprint_frees_and_in_focus_what_pixel_frees():
    focus = np.zeros(bits.word_count(GRID), dtype=bool)
    focus[::2] = True
    pixel = reconstruct(GRID, [CAMERA], [a_frame()]).free_words
    footprint = reconstruct(GRID, [CAMERA], [a_frame()], detail="footprint").free_words
    focused = reconstruct(GRID, [CAMERA], [a_frame()], focus=focus).free_words
    assert (focused == np.where(focus, pixel, footprint)).all()
    assert np.bitwise_count(pixel).sum() > np.bitwise_count(footprint).sum() > 0
    assert not (footprint & ~pixel).any()
