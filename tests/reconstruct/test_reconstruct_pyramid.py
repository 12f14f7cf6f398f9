import numpy as np
import pytest

from elbowroom.geometry.kernels.noise import DepthMargin
from elbowroom.reconstruct.kernels import flying, pyramid, texels
from elbowroom.reconstruct.kernels.texels import NEUTRAL, Counting
from reference import reconstruct_pyramid as naive
from reference.reconstruct_pyramid import NO_RETURN, bounds_of, packed

SHAPES = [(1, 1), (1, 7), (6, 1), (2, 2), (5, 3), (9, 16), (23, 18)]
NO_MODEL = np.zeros((0, 0), dtype=np.float32)
NO_TEXELS = np.zeros((0, 0), dtype=np.uint32)
NO_MARGIN = DepthMargin(0.0, 0.0, 0.0, 0.0, 0.0)
QUANTUM = 1e-4


def counting(margin=NO_MARGIN, quantum=QUANTUM, least=0.0, greatest=np.inf):
    return Counting(least, greatest, quantum, margin)


def all_of(image):
    """All pixels of an image: first row, one past the last, first column, one past the last."""
    return 0, image.shape[0], 0, image.shape[1]


def random_texels(shape, seed=0):
    rng = np.random.default_rng(seed)
    least = rng.integers(0, 60000, shape)
    greatest = np.where(rng.random(shape) < 0.1, NO_RETURN, least + rng.integers(1, 5000, shape))
    return packed(np.where(greatest == NO_RETURN, 0, least), greatest)


def test_texels_bound_a_depth_by_at_most_three_quanta():
    quantum = 8e-5
    depth = np.random.default_rng(0).uniform(0.001, 5.2, (40, 50)).astype(np.float32)
    trust = np.zeros(depth.shape, dtype=np.uint32)
    texels.texels_of_frame(
        (depth, depth), counting(quantum=quantum), NO_MODEL, (trust, NO_TEXELS), all_of(depth)
    )
    least, greatest = bounds_of(trust)
    exact = depth.astype(float) / quantum
    assert ((exact - 3 < least) & (least <= exact)).all()
    assert ((exact <= greatest) & (greatest < exact + 3)).all()


@pytest.mark.parametrize("depth", [0.0, -0.0, -1.0, np.nan, np.inf, -np.inf, 0.19, 4.01, 1e30])
def test_what_is_no_depth_within_range_is_no_return(depth):
    image = np.full((2, 3), depth, dtype=np.float32)
    trust = np.ones(image.shape, dtype=np.uint32)
    within = counting(least=0.2, greatest=4.0)
    texels.texels_of_frame((image, image), within, NO_MODEL, (trust, NO_TEXELS), all_of(image))
    least, greatest = bounds_of(trust)
    assert (least == 0).all()
    assert (greatest == NO_RETURN).all()


def test_a_depth_beyond_what_can_be_counted_is_far_and_not_missing():
    image = np.array([[1e6]], dtype=np.float32)
    trust = np.zeros(image.shape, dtype=np.uint32)
    texels.texels_of_frame((image, image), counting(), NO_MODEL, (trust, NO_TEXELS), all_of(image))
    least, greatest = bounds_of(trust)
    assert 65000 < least[0, 0] <= greatest[0, 0] < NO_RETURN


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("ignoring", [False, True])
def test_steps_fall_to_the_nearest_neighbour(shape, ignoring):
    rng = np.random.default_rng(1)
    trust = random_texels(shape, 1)
    ignored = rng.random(shape) < (0.3 if ignoring else 0.0)
    step = DepthMargin(0.2, 0.05, 0.01, 0.02, 1.0)
    got = np.zeros_like(trust)
    mask = np.where(ignored, NEUTRAL, trust)
    flying.lower_at_steps(trust, mask, QUANTUM, step, got)
    least, greatest = bounds_of(trust)
    z = least * QUANTUM
    threshold = 0.2 + 0.05 * z + 0.01 * z**2 + 0.02 * np.maximum(z - 1, 0) ** 2
    expected = naive.lowered(least, ignored, threshold / QUANTUM)
    np.testing.assert_array_equal(bounds_of(got)[0], expected)
    np.testing.assert_array_equal(bounds_of(got)[1], greatest)
    assert ignoring or (expected != least).any() == (max(shape) > 1)


@pytest.mark.parametrize("shape", SHAPES)
def test_levels_and_windows_are_minima_over_pixels(shape):
    fine = random_texels(shape, 2)
    least, greatest = bounds_of(fine)
    for k in range(int(np.ceil(np.log2(max(shape)))) + 2):
        if k:
            coarse = np.zeros(tuple(-(-n // 2) for n in fine.shape), dtype=np.uint32)
            pyramid.halve(fine, (0, 0), all_of(fine), coarse)
            fine = coarse
        for got, expected in zip(bounds_of(fine), naive.level(least, greatest, k), strict=True):
            np.testing.assert_array_equal(got, expected)
        windows = np.zeros_like(fine)
        pyramid.windows_of(fine, (0, 0), all_of(fine), windows)
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
    flying.pass_over_specks(packed(least, greatest), 0.01, NO_MODEL, counting(), got)
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
    flying.pass_over_specks(packed(least, least + 2), 0.01, NO_MODEL, counting(), got)
    assert (bounds_of(got)[0][speck] > 19000).all() == passed


def test_where_the_machine_is_about_a_pixel_it_says_how_far_a_speck_is_free():
    margin = DepthMargin(0.01, 0.0, 0.0, 0.0, 0.0)
    least = np.full((5, 6), 20000)
    least[2, 2:4] = 0
    model = np.zeros(least.shape, dtype=np.float32)
    model[2, 2], model[2, 3] = -1.5, -1e-6
    got = np.zeros(least.shape, dtype=np.uint32)
    flying.pass_over_specks(packed(least, least + 2), 0.01, model, counting(margin), got)
    assert bounds_of(got)[0][2, 2] * QUANTUM == pytest.approx(1.51, abs=3 * QUANTUM)
    assert bounds_of(got)[0][2, 3] == 0


def test_an_explained_pixel_is_free_up_to_the_model_and_silent():
    margin = DepthMargin(0.01, 0.002, 0.0, 0.0, 0.0)
    model = np.array([[0.0, -1e-6, np.inf, -1.5, 1.5, 3.0]], dtype=np.float32)
    before = random_texels(model.shape, 3)
    trust, doubt = before.copy(), before.copy()
    texels.mark_row(model[0], counting(margin), trust[0], doubt[0])
    np.testing.assert_array_equal(trust[0, :4], before[0, :4])
    np.testing.assert_array_equal(doubt[0, :2], before[0, :2])
    assert (doubt[0, 2:] == NEUTRAL).all()
    # a voxel whose far side plus margin lies at this depth is compared with it, so the margin is in it
    up_to = bounds_of(trust)[0][0, 4:] * QUANTUM - (0.01 + 0.002 * model[0, 4:])
    assert (up_to <= model[0, 4:]).all()
    np.testing.assert_allclose(up_to, model[0, 4:], atol=3 * QUANTUM)


@pytest.mark.parametrize("shape", [*SHAPES, (31, 40)])
def test_tiles_of_a_rectangle_are_the_least_of_their_texels_and_others_stay(shape):
    rng = np.random.default_rng(7)
    trust = random_texels(shape, 6)
    least, greatest = naive.level(*bounds_of(trust), 2)
    for _ in range(20):
        top, left = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        bottom, right = rng.integers(top, shape[0]) + 1, rng.integers(left, shape[1]) + 1
        tiles = np.full(least.shape, 7, dtype=np.uint32)
        pyramid.fill_tiles(trust, (top, bottom, left, right), tiles)
        asked = np.zeros(least.shape, dtype=bool)
        asked[top // 4 : -(-bottom // 4), left // 4 : -(-right // 4)] = True
        np.testing.assert_array_equal(bounds_of(tiles)[0][asked], least[asked])
        np.testing.assert_array_equal(bounds_of(tiles)[1][asked], greatest[asked])
        assert (tiles[~asked] == 7).all()
    tiles = np.full(least.shape, 7, dtype=np.uint32)
    pyramid.fill_tiles(trust, (0, 0, 0, shape[1]), tiles)
    assert (tiles == 7).all()


def test_doubt_differs_from_trust_within_the_rectangle_alone():
    rng = np.random.default_rng(8)
    depth = rng.uniform(1.0, 4.0, (50, 200)).astype(np.float32)
    within = counting(DepthMargin(0.01, 0.0, 0.0, 0.0, 0.0))
    for _ in range(10):
        model = np.zeros_like(depth)
        v, u = rng.integers(0, 50, 3), rng.integers(0, 200, 3)
        model[v, u] = depth[v, u]
        trust, doubt = (np.zeros(depth.shape, dtype=np.uint32) for _ in range(2))
        top, bottom, left, right = texels.texels_of_frame(
            (depth, depth), within, model, (trust, doubt), all_of(depth)
        )
        differs = trust != doubt
        assert differs[v, u].all()
        differs[top:bottom, left:right] = False
        assert not differs.any()
        plain = np.zeros_like(trust)
        texels.texels_of_frame((depth, depth), within, NO_MODEL, (plain, NO_TEXELS), all_of(depth))
        np.testing.assert_array_equal(plain[model == 0], trust[model == 0])
        np.testing.assert_array_equal(plain[model == 0], doubt[model == 0])


@pytest.mark.parametrize("shape", [*SHAPES, (31, 40)])
def test_squares_hold_the_least_of_the_texels_from_each_on(shape):
    smaller = random_texels(shape, 4)
    least, greatest = bounds_of(smaller)
    for edge in (2, 4, 8):
        squares = np.zeros(shape, dtype=np.uint32)
        pyramid.squares_of(smaller, edge, (0, shape[0], 0, shape[1]), squares)
        for v, u in np.ndindex(shape):
            here = (slice(v, v + edge), slice(u, u + edge))
            assert bounds_of(squares[v, u]) == (least[here].min(), greatest[here].max())
        smaller = squares


def test_the_least_of_a_rectangle_of_tiles_is_the_least_of_all_in_it():
    shape, first = (17, 23), 5
    tiles = random_texels(shape, 5)
    least, greatest = bounds_of(tiles)
    flat = np.zeros(first + tiles.size, dtype=np.uint32)
    flat[first:] = tiles.reshape(-1)
    squares = [flat]
    smaller = tiles
    for edge in (2, 4, 8):
        squares.append(np.zeros_like(flat))
        larger = np.zeros_like(tiles)
        pyramid.squares_of(smaller, edge, (0, shape[0], 0, shape[1]), larger)
        squares[-1][first:] = larger.reshape(-1)
        smaller = larger
    rng = np.random.default_rng(6)
    for _ in range(300):
        top, left = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        bottom, right = rng.integers(top, shape[0]), rng.integers(left, shape[1])
        got = pyramid.least_of_tiles(np.array(squares), first, shape[1], (top, bottom, left, right))
        here = (slice(top, bottom + 1), slice(left, right + 1))
        assert bounds_of(np.uint32(got)) == (least[here].min(), greatest[here].max())


def in_passes(depth, counted, model, step, within):
    """Level 0 of a part of an image whose pixels fly, one pass after the other; trust, doubt, and where they differ."""
    top, bottom, left, right = within
    depth, model = (np.ascontiguousarray(image[top:bottom, left:right]) for image in (depth, model))
    plain, neutral, between, lowered = (np.zeros(depth.shape, dtype=np.uint32) for _ in range(4))
    apart = texels.texels_of_frame((depth, depth), counted, model, (plain, neutral), all_of(depth))
    flying.pass_over_specks(plain, 0.01, model, counted, between)
    flying.lower_at_steps(between, neutral, counted.quantum, step, lowered)
    for v in range(len(depth)):
        texels.mark_row(model[v], counted, lowered[v], neutral[v])
    return lowered, neutral, (apart[0] + top, apart[1] + top, apart[2] + left, apart[3] + left)


def flying_image(rows, columns):
    """Depth with holes, a step and noise; a machine in some of it, or in none at all where there is one row."""
    rng = np.random.default_rng(rows)
    depth = (2.0 + 0.3 * rng.random((rows, columns))).astype(np.float32)
    depth[rng.random(depth.shape) < 0.1] = 0
    depth[:, columns // 2 :] += 1
    model = np.where(rng.random(depth.shape) < 0.3, rng.choice([-2.5, -1e-6, 2.1, np.inf], depth.shape), 0)
    model[rows // 3 : rows // 2] = 0
    for image in (depth, model := model.astype(np.float32)):
        image.setflags(write=False)
    return depth, model


@pytest.mark.parametrize(
    ("rows", "columns"), [(1, 9), (2, 8), (3, 3), (4, 5), (5, 4), (6, 6), (23, 40), (25, 64), (77, 130)]
)
def test_flying_pixels_row_by_row_are_one_pass_after_the_other(rows, columns):
    depth, model = flying_image(rows, columns)
    step, counted = DepthMargin(0.05, 0.0, 0.0, 0.0, 0.0), counting(DepthMargin(0.01, 0.002, 0.0, 0.0, 0.0))
    trust, doubt = (np.zeros(depth.shape, dtype=np.uint32) for _ in range(2))
    got = flying.fly((depth, depth), counted, model, (0.01, step), (trust, doubt), all_of(depth))
    due = in_passes(depth, counted, model, step, all_of(depth))
    assert got == due[2]
    np.testing.assert_array_equal(trust, due[0])
    np.testing.assert_array_equal(doubt, due[1])


def test_a_part_of_an_image_is_as_in_all_of_it_but_at_sides_of_its_own():
    depth, model = flying_image(77, 130)
    step, counted = DepthMargin(0.05, 0.0, 0.0, 0.0, 0.0), counting(DepthMargin(0.01, 0.002, 0.0, 0.0, 0.0))
    whole = in_passes(depth, counted, model, step, all_of(depth))
    rng = np.random.default_rng(9)
    for _ in range(30):
        top, left = rng.integers(0, 77), rng.integers(0, 130)
        bottom, right = rng.integers(top, 77) + 1, rng.integers(left, 130) + 1
        part = int(top), int(bottom), int(left), int(right)
        trust, doubt = (np.full(depth.shape, 7, dtype=np.uint32) for _ in range(2))
        got = flying.fly((depth, depth), counted, model, (0.01, step), (trust, doubt), part)
        due = in_passes(depth, counted, model, step, part)
        assert got == due[2]
        outside = np.ones(depth.shape, dtype=bool)
        outside[top:bottom, left:right] = False
        assert (trust[outside] == 7).all()
        assert (doubt[outside] == 7).all()
        np.testing.assert_array_equal(trust[top:bottom, left:right], due[0])
        np.testing.assert_array_equal(doubt[top:bottom, left:right], due[1])
        rows, columns = (
            slice(begin + flying.SPREAD * (begin > 0), end - flying.SPREAD * (end < size))
            for begin, end, size in ((top, bottom, 77), (left, right, 130))
        )
        np.testing.assert_array_equal(trust[rows, columns], whole[0][rows, columns])
        np.testing.assert_array_equal(doubt[rows, columns], whole[1][rows, columns])


def test_levels_of_a_part_of_an_image_are_minima_over_pixels_of_that_part():
    shape = (37, 54)
    fine = random_texels(shape, 2)
    least, greatest = bounds_of(fine)
    rng = np.random.default_rng(10)
    for _ in range(10):
        top, left = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        bottom, right = rng.integers(top, shape[0]) + 1, rng.integers(left, shape[1]) + 1
        outside = np.ones(shape, dtype=bool)
        outside[top:bottom, left:right] = False
        low, high = np.where(outside, NO_RETURN, least), np.where(outside, 0, greatest)
        level, origin, within = fine, (0, 0), tuple(map(int, (top, bottom, left, right)))
        for k in range(6):
            if k:
                above = within[0] // 2, -(-within[1] // 2), within[2] // 2, -(-within[3] // 2)
                coarse = np.zeros((above[1] - above[0], above[3] - above[2]), dtype=np.uint32)
                pyramid.halve(level, origin, within, coarse)
                level, origin, within = coarse, (above[0], above[2]), above
            windows = np.full(tuple(-(-n // 2**k) for n in shape), 7, dtype=np.uint32)
            pyramid.windows_of(level, origin, within, windows)
            got = bounds_of(windows)
            for v in range(within[0], within[1]):
                for u in range(within[2], within[3]):
                    assert (got[0][v, u], got[1][v, u]) == naive.window(low, high, k, u << k, v << k)
            windows[within[0] : within[1], within[2] : within[3]] = 7
            assert (windows == 7).all()
