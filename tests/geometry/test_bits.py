import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from elbowroom.errors import GridError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.kernels.bits import bit_count, bit_of, word_of

sides = st.integers(1, 37)


def grid_of(shape):
    return VoxelGrid((0, 0, 0), shape, 0.1)


@given(shape=st.tuples(sides, sides, sides), seed=st.integers(0, 2**32 - 1))
def test_packing_loses_nothing_and_adds_nothing(shape, seed):
    grid = grid_of(shape)
    mask = np.random.default_rng(seed).random(shape) < 0.3
    words = bits.pack(mask, grid)
    assert words.dtype == np.uint64 and words.size == bits.word_count(grid)
    np.testing.assert_array_equal(bits.unpack(words, grid), mask)
    # beyond the grid there are zeros
    assert np.bitwise_count(words).sum() == mask.sum()


def test_the_place_of_a_voxel_is_where_its_bit_is():
    grid = grid_of((21, 18, 35))
    for index in [(0, 0, 0), (20, 17, 34), (3, 4, 16), (16, 0, 5)]:
        mask = np.zeros(grid.shape, dtype=bool)
        mask[index] = True
        words = np.zeros(bits.word_count(grid), dtype=np.uint64)
        word, bit = bits.place_of(index, grid)
        words[word] |= bit
        np.testing.assert_array_equal(words, bits.pack(mask, grid))


@njit
def _where(i, j, k, cubes_y, cubes_z):
    return word_of(i, j, k, cubes_y, cubes_z), bit_of(i, j, k)


@given(shape=st.tuples(sides, sides, sides), data=st.data())
def test_a_voxels_bit_is_where_kernels_look_for_it(shape, data):
    grid = grid_of(shape)
    i, j, k = (data.draw(st.integers(0, n - 1)) for n in shape)
    mask = np.zeros(shape, dtype=bool)
    mask[i, j, k] = True
    cells = bits.lattice(grid)
    word, bit = _where(i, j, k, cells.cubes_y, cells.cubes_z)
    expected = bits.empty(grid)
    expected[word] = bit
    np.testing.assert_array_equal(bits.pack(mask, grid), expected)


def test_bit_order_is_the_documented_one():
    """Within a word z is fastest, then y, then x; words of a cube likewise; cubes likewise."""
    grid = grid_of((32, 32, 32))
    for index, word, bit in (((0, 0, 1), 0, 1), ((0, 1, 0), 0, 4), ((1, 0, 0), 0, 16), ((0, 0, 4), 1, 0)):
        mask = np.zeros(grid.shape, dtype=bool)
        mask[index] = True
        words = bits.pack(mask, grid)
        assert words[word] == 1 << bit
    assert bits.lattice(grid).cubes_z == 2
    mask[:] = False
    mask[16, 0, 0] = True
    assert bits.pack(mask, grid)[4 * 64] == 1


def test_inside_is_every_voxel_and_nothing_beyond():
    grid = grid_of((5, 17, 33))
    assert np.bitwise_count(bits.inside(grid)).sum() == grid.size
    assert bits.unpack(bits.inside(grid), grid).all()
    assert not bits.empty(grid).any()


@pytest.mark.parametrize(
    "mask", [np.zeros((2, 2, 3), bool), np.zeros((2, 2, 2), np.uint8), np.zeros((2, 2), bool)]
)
def test_a_volume_of_another_kind_is_refused(mask):
    with pytest.raises(GridError, match=r"expected a bool array of shape \(2, 2, 2\)"):
        bits.pack(mask, grid_of((2, 2, 2)))


@pytest.mark.parametrize("word", [0, 1, 0x8000000000000000, 0xFFFFFFFFFFFFFFFF, 0x0123456789ABCDEF])
def test_bits_of_a_word_are_counted(word):
    assert int(bit_count(np.uint64(word))) == word.bit_count()
