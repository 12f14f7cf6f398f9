import numpy as np
import pytest

from elbowroom.reconstruct.kernels import pyramid as kernels
from elbowroom.reconstruct.kernels.look import least_of_tiles
from reference import reconstruct_pyramid as naive
from reference.reconstruct_pyramid import NO_RETURN, bounds_of, packed

SHAPES = [(1, 1), (1, 7), (6, 1), (2, 2), (5, 3), (9, 16), (23, 18)]
NO_MODEL = np.zeros((0, 0), dtype=np.float32)
NO_TEXELS = np.zeros((0, 0), dtype=np.uint32)
NO_MARGIN = np.zeros(5)


def random_texels(shape, seed=0):
    rng = np.random.default_rng(seed)
    least = rng.integers(0, 60000, shape)
    greatest = np.where(rng.random(shape) < 0.1, NO_RETURN, least + rng.integers(1, 5000, shape))
    return packed(np.where(greatest == NO_RETURN, 0, least), greatest)


def test_texels_bound_a_depth_by_at_most_three_quanta():
    quantum = np.float32(8e-5)
    depth = np.random.default_rng(0).uniform(0.001, 5.2, (40, 50)).astype(np.float32)
    texels = np.zeros(depth.shape, dtype=np.uint32)
    kernels.texels_of_frame(
        depth, depth, np.float32(0), np.float32(np.inf), quantum, NO_MODEL, NO_MARGIN, texels, NO_TEXELS
    )
    least, greatest = bounds_of(texels)
    exact = depth.astype(float) / float(quantum)
    assert ((exact - 3 < least) & (least <= exact)).all()
    assert ((exact <= greatest) & (greatest < exact + 3)).all()


@pytest.mark.parametrize("depth", [0.0, -0.0, -1.0, np.nan, np.inf, -np.inf, 0.19, 4.01, 1e30])
def test_what_is_no_depth_within_range_is_no_return(depth):
    image = np.full((2, 3), depth, dtype=np.float32)
    texels = np.ones(image.shape, dtype=np.uint32)
    kernels.texels_of_frame(
        image,
        image,
        np.float32(0.2),
        np.float32(4.0),
        np.float32(1e-4),
        NO_MODEL,
        NO_MARGIN,
        texels,
        NO_TEXELS,
    )
    least, greatest = bounds_of(texels)
    assert (least == 0).all()
    assert (greatest == NO_RETURN).all()


def test_a_depth_beyond_what_can_be_counted_is_far_and_not_missing():
    image = np.array([[1e6]], dtype=np.float32)
    texels = np.zeros(image.shape, dtype=np.uint32)
    kernels.texels_of_frame(
        image,
        image,
        np.float32(0),
        np.float32(np.inf),
        np.float32(1e-4),
        NO_MODEL,
        NO_MARGIN,
        texels,
        NO_TEXELS,
    )
    least, greatest = bounds_of(texels)
    assert 65000 < least[0, 0] <= greatest[0, 0] < NO_RETURN


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("ignoring", [False, True])
def test_steps_fall_to_the_nearest_neighbour(shape, ignoring):
    rng = np.random.default_rng(1)
    texels = random_texels(shape, 1)
    ignored = rng.random(shape) < (0.3 if ignoring else 0.0)
    quantum, margin = 1e-4, np.array([0.2, 0.05, 0.01, 0.02, 1.0])
    got = np.zeros_like(texels)
    mask = np.where(ignored, kernels.NEUTRAL, texels)
    kernels.lower_at_steps(texels, mask, quantum, margin, got)
    least, greatest = bounds_of(texels)
    z = least * quantum
    threshold = 0.2 + 0.05 * z + 0.01 * z**2 + 0.02 * np.maximum(z - 1, 0) ** 2
    expected = naive.lowered(least, ignored, threshold / quantum)
    np.testing.assert_array_equal(bounds_of(got)[0], expected)
    np.testing.assert_array_equal(bounds_of(got)[1], greatest)
    assert ignoring or (expected != least).any() == (max(shape) > 1)


@pytest.mark.parametrize("shape", SHAPES)
def test_levels_and_windows_are_minima_over_pixels(shape):
    texels = random_texels(shape, 2)
    least, greatest = bounds_of(texels)
    fine = texels
    for k in range(int(np.ceil(np.log2(max(shape)))) + 2):
        if k:
            coarse = np.zeros(tuple(-(-n // 2) for n in fine.shape), dtype=np.uint32)
            kernels.halve(fine, coarse)
            fine = coarse
        for got, expected in zip(bounds_of(fine), naive.level(least, greatest, k), strict=True):
            np.testing.assert_array_equal(got, expected)
        windows = np.zeros_like(fine)
        kernels.windows_of(fine.view(np.uint16), np.zeros_like(fine).view(np.uint16), windows.view(np.uint16))
        low, high = bounds_of(windows)
        for v, u in np.ndindex(shape):
            assert (low[v >> k, u >> k], high[v >> k, u >> k]) == naive.window(least, greatest, k, u, v)


def test_a_window_reaches_far_enough_and_holds_the_window_of_the_level_below():
    ones = np.ones((40, 40), dtype=int)
    for k in range(4):
        for u in range(40):
            seen = [v for v in range(40) if naive.window(ones - (np.arange(40) == v), ones, k, u, 20)[0] == 0]
            below = [
                v
                for v in range(40)
                if naive.window(ones - (np.arange(40) == v), ones, max(k - 1, 0), u, 20)[0] == 0
            ]
            assert set(range(max(u - (2 << k), 0), min(u + (2 << k) + 1, 40))) <= set(seen)
            assert set(below) <= set(seen)


def test_specks_are_as_free_as_their_neighbours_less_a_pitch():
    rng = np.random.default_rng(4)
    least = rng.integers(20000, 30000, (30, 41))
    greatest = least + 10
    holes, near = rng.random(least.shape) < 0.08, rng.random(least.shape) < 0.05
    least[near] //= 10
    least[holes], greatest[holes] = 0, NO_RETURN
    got = np.zeros(least.shape, dtype=np.uint32)
    kernels.pass_over_specks(packed(least, greatest), 0.01, NO_MODEL, NO_MARGIN, 1e-4, got)
    expected = naive.past_specks(least, 0.01)
    np.testing.assert_array_equal(bounds_of(got)[0], expected)
    np.testing.assert_array_equal(bounds_of(got)[1], greatest)
    assert (expected > least)[holes].mean() > 0.3


@pytest.mark.parametrize(
    "size, passed", [((1, 1), True), ((1, 2), True), ((2, 1), True), ((1, 3), False), ((2, 2), False)]
)
def test_what_is_wider_than_two_pixels_is_no_speck(size, passed):
    least = np.full((12, 14), 20000)
    speck = (slice(5, 5 + size[0]), slice(6, 6 + size[1]))
    least[speck] = 3000
    got = np.zeros(least.shape, dtype=np.uint32)
    kernels.pass_over_specks(packed(least, least + 2), 0.01, NO_MODEL, NO_MARGIN, 1e-4, got)
    assert (bounds_of(got)[0][speck] > 19000).all() == passed


def test_where_the_machine_is_about_a_pixel_it_says_how_far_a_speck_is_free():
    quantum, margin = 1e-4, np.array([0.01, 0.0, 0.0, 0.0, 0.0])
    least = np.full((5, 6), 20000)
    least[2, 2:4] = 0
    model = np.zeros(least.shape, dtype=np.float32)
    model[2, 2], model[2, 3] = -1.5, -1e-6
    got = np.zeros(least.shape, dtype=np.uint32)
    kernels.pass_over_specks(packed(least, least + 2), 0.01, model, margin, quantum, got)
    assert bounds_of(got)[0][2, 2] * quantum == pytest.approx(1.51, abs=3 * quantum)
    assert bounds_of(got)[0][2, 3] == 0


def test_an_explained_pixel_is_free_up_to_the_model_and_silent():
    quantum, margin = 1e-4, np.array([0.01, 0.002, 0.0, 0.0, 0.0])
    model = np.array([[0.0, -1e-6, np.inf, -1.5, 1.5, 3.0]], dtype=np.float32)
    texels = random_texels(model.shape, 3)
    trust, doubt = texels.copy(), texels.copy()
    kernels.mark_explained(model, margin, quantum, trust, doubt)
    np.testing.assert_array_equal(trust[0, :4], texels[0, :4])
    np.testing.assert_array_equal(doubt[0, :2], texels[0, :2])
    assert (doubt[0, 2:] == kernels.NEUTRAL).all()
    # a voxel whose far side plus margin lies at this depth is compared with it, so the margin is in it
    up_to = bounds_of(trust)[0][0, 4:] * quantum - (0.01 + 0.002 * model[0, 4:])
    assert (up_to <= model[0, 4:]).all()
    np.testing.assert_allclose(up_to, model[0, 4:], atol=3 * quantum)


@pytest.mark.parametrize("shape", [*SHAPES, (31, 40)])
def test_tiles_of_a_rectangle_are_the_least_of_their_texels_and_others_stay(shape):
    rng = np.random.default_rng(7)
    texels = random_texels(shape, 6)
    least, greatest = naive.level(*bounds_of(texels), 2)
    for _ in range(20):
        top, left = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        bottom, right = rng.integers(top, shape[0]) + 1, rng.integers(left, shape[1]) + 1
        tiles = np.full(least.shape, 7, dtype=np.uint32)
        kernels.fill_tiles(texels, top, bottom, left, right, tiles)
        asked = np.zeros(least.shape, dtype=bool)
        asked[top // 4 : -(-bottom // 4), left // 4 : -(-right // 4)] = True
        np.testing.assert_array_equal(bounds_of(tiles)[0][asked], least[asked])
        np.testing.assert_array_equal(bounds_of(tiles)[1][asked], greatest[asked])
        assert (tiles[~asked] == 7).all()
    tiles = np.full(least.shape, 7, dtype=np.uint32)
    kernels.fill_tiles(texels, 0, 0, 0, shape[1], tiles)
    assert (tiles == 7).all()


def test_doubt_differs_from_trust_within_the_rectangle_alone():
    rng = np.random.default_rng(8)
    depth = rng.uniform(1.0, 4.0, (50, 200)).astype(np.float32)
    quantum, margin = np.float32(1e-4), np.array([0.01, 0.0, 0.0, 0.0, 0.0])
    for _ in range(10):
        model = np.zeros_like(depth)
        v, u = rng.integers(0, 50, 3), rng.integers(0, 200, 3)
        model[v, u] = depth[v, u]
        trust, doubt = (np.zeros(depth.shape, dtype=np.uint32) for _ in range(2))
        top, bottom, left, right = kernels.texels_of_frame(
            depth, depth, np.float32(0), np.float32(np.inf), quantum, model, margin, trust, doubt
        )
        differs = trust != doubt
        assert differs[v, u].all()
        differs[top:bottom, left:right] = False
        assert not differs.any()
        plain = np.zeros_like(trust)
        kernels.texels_of_frame(
            depth, depth, np.float32(0), np.float32(np.inf), quantum, NO_MODEL, NO_MARGIN, plain, NO_TEXELS
        )
        np.testing.assert_array_equal(plain[model == 0], trust[model == 0])
        np.testing.assert_array_equal(plain[model == 0], doubt[model == 0])


@pytest.mark.parametrize("shape", [*SHAPES, (31, 40)])
def test_squares_hold_the_least_of_the_texels_from_each_on(shape):
    smaller = random_texels(shape, 4)
    least, greatest = bounds_of(smaller)
    for edge in (2, 4, 8):
        squares = np.zeros(shape, dtype=np.uint32)
        kernels.squares_of(smaller, edge, squares)
        for v, u in np.ndindex(shape):
            here = (slice(v, v + edge), slice(u, u + edge))
            assert bounds_of(squares[v, u]) == (least[here].min(), greatest[here].max())
        smaller = squares


def test_the_least_of_a_rectangle_of_tiles_is_the_least_of_all_in_it():
    shape, first = (17, 23), 5
    tiles = random_texels(shape, 5)
    least, greatest = bounds_of(tiles)
    flat, squares = np.zeros(first + tiles.size, dtype=np.uint32), []
    flat[first:] = tiles.reshape(-1)
    smaller = tiles
    for edge in (2, 4, 8):
        squares.append(np.zeros_like(flat))
        larger = np.zeros_like(tiles)
        kernels.squares_of(smaller, edge, larger)
        squares[-1][first:] = larger.reshape(-1)
        smaller = larger
    rng = np.random.default_rng(6)
    for _ in range(300):
        top, left = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        bottom, right = rng.integers(top, shape[0]), rng.integers(left, shape[1])
        got = least_of_tiles(flat, np.array(squares), first, shape[1], top, bottom, left, right)
        here = (slice(top, bottom + 1), slice(left, right + 1))
        assert bounds_of(np.uint32(got)) == (least[here].min(), greatest[here].max())
