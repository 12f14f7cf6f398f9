"""Sections show each voxel in its colour, at its place."""

import numpy as np
import pytest
from PIL import Image

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.view import depth_picture, save_sections, section
from elbowroom.view.draw.outline import cut_lines
from elbowroom.view.draw.palette import COLOURS, Label, labels, shares
from elbowroom.view.draw.plot import TOP_PX, Plot, _tick_step, _ticks

GRID = VoxelGrid(origin_m=(-1.0, 2.0, 0.5), shape=(20, 30, 25), voxel_size_m=0.1)


def a_space() -> FreeSpace:
    """Free but for one surface voxel, one blind and one unseen voxel, and one of the machine's own body."""
    surface, blind, blocked, body = (np.zeros(GRID.shape, dtype=bool) for _ in range(4))
    surface[2, 3, 4] = blind[5, 3, 4] = body[8, 3, 4] = True
    blocked[2, 3, 4] = blocked[5, 3, 4] = blocked[11, 3, 4] = True
    return FreeSpace(
        GRID,
        bits.pack(~blocked, GRID),
        bits.pack(surface, GRID),
        bits.pack(blind, GRID),
        bits.pack(surface | blind, GRID),
        bits.pack(body, GRID),
    )


def pixel_of(picture: Image.Image, first: int, second: int, columns: int, rows: int) -> tuple[int, ...]:
    """The colour at the centre of a cell; cells go to the right and up."""
    edge = 1000 // max(columns, rows)
    left = max(84, (picture.width - columns * edge) // 2)
    x = left + first * edge + edge // 2
    y = TOP_PX + (rows - 1 - second) * edge + edge // 2
    return picture.convert("RGB").getpixel((x, y))


def test_each_voxel_has_exactly_one_label_and_shares_add_up():
    volume = labels(a_space())
    assert [volume[i, 3, 4] for i in (2, 5, 8, 11, 14)] == [
        Label.SURFACE,
        Label.BLIND,
        Label.BODY,
        Label.UNSEEN,
        Label.FREE,
    ]
    assert sum(shares(volume).values()) == pytest.approx(1)
    assert shares(volume)[Label.SURFACE] == pytest.approx(1 / GRID.size)


@pytest.mark.parametrize(
    ("axis", "at_m", "cell", "columns", "rows"),
    [
        ("z", 0.95, lambda i: (i, 3), 20, 30),
        ("y", 2.35, lambda i: (i, 4), 20, 25),
    ],
)
def test_colours_lie_at_the_places_of_their_voxels(axis, at_m, cell, columns, rows):
    picture = section(a_space(), axis, at_m)
    assert picture.width >= 900
    for i, label in ((2, "SURFACE"), (5, "BLIND"), (8, "BODY"), (11, "UNSEEN"), (14, "FREE")):
        assert pixel_of(picture, *cell(i), columns, rows) == COLOURS[Label[label]], label


def test_section_along_x_has_y_to_the_right():
    picture = section(a_space(), "x", -0.75)
    assert pixel_of(picture, 3, 4, 30, 25) == COLOURS[Label.SURFACE]
    assert pixel_of(picture, 4, 3, 30, 25) == COLOURS[Label.FREE]


@pytest.mark.parametrize("at_m", [0.49, 3.01, float("nan")])
def test_section_outside_the_grid_is_refused(at_m):
    with pytest.raises(InputError, match=r"outside the grid, which reaches from 0\.5 to 3 m"):
        section(a_space(), "z", at_m)


def test_unknown_axis_is_refused():
    with pytest.raises(InputError, match="allowed are x, y, z"):
        section(a_space(), "xy", 1.0)


def test_five_sections_are_saved_and_nothing_else(tmp_path):
    paths = save_sections(a_space(), tmp_path / "new")
    assert sorted(paths) == sorted((tmp_path / "new").iterdir())
    assert [path.stem for path in paths] == [f"section_{name}" for name in ("z1", "z2", "z3", "y", "x")]


def test_a_low_grid_still_gives_five_pictures(tmp_path):
    grid = VoxelGrid(origin_m=(0, 0, 0), shape=(3, 2, 1), voxel_size_m=0.01)
    space = FreeSpace.from_occupied(grid, np.zeros(grid.shape, dtype=bool))
    assert len(set(save_sections(space, tmp_path))) == 5


def test_more_voxels_than_pixels_are_thinned_out():
    plot = Plot.of_cells(np.zeros((5000, 10, 3), dtype=np.uint8), np.zeros(2), 0.01)
    assert plot.size_px == (1000, 2)


def test_a_camera_is_marked_where_it_stands():
    pose = np.eye(4)
    pose[:3, 3] = (0.05, 3.55, 1.0)
    pinhole = Intrinsics(fx=10, fy=10, cx=4.5, cy=4.5)
    camera = DepthCamera(name="c", width=10, height=10, world_from_camera=pose, intrinsics=pinhole)
    plain, marked = (np.array(section(a_space(), "z", 2.0, cameras=c)) for c in ([], [camera]))
    rows, columns = np.nonzero((plain != marked).any(axis=-1)[: TOP_PX + 990])
    assert abs(rows.mean() - (TOP_PX + 14.5 * 33)) < 2
    assert abs(columns.mean() - (plain.shape[1] - 20 * 33) // 2 - 10.5 * 33) < 2


def test_a_plane_cuts_a_triangle_in_a_segment():
    triangle = np.array([[[0.0, 0, 0], [2, 0, 2], [0, 4, 2]]])
    lines = cut_lines(triangle, 2, 1.0)
    np.testing.assert_allclose(sorted(lines[0].tolist()), [[0, 2, 1], [1, 0, 1]])
    assert cut_lines(triangle, 2, 3.0).shape == (0, 2, 3)


@pytest.mark.parametrize("extent_m", [0.02, 0.1, 0.7, 2.5, 4, 9.9, 120])
def test_ticks_are_few_and_inside(extent_m):
    step, digits = _tick_step(extent_m)
    ticks = _ticks(-0.3, extent_m - 0.3, step)
    assert 3 <= len(ticks) <= 12
    assert ticks[0] >= -0.3 - 1e-6 and ticks[-1] <= extent_m - 0.3 + 1e-6
    assert round(step, digits) == pytest.approx(step)


def test_depth_picture_leaves_no_return_white_and_near_bright():
    depth = np.array([[0.0, np.nan, 1.0, 5.0]])
    pixels = np.array(depth_picture(depth, near_m=1.0, far_m=5.0))[0].astype(int)
    assert pixels[0].tolist() == pixels[1].tolist() == [255, 255, 255]
    assert pixels[2].sum() > 2 * pixels[3].sum()


def test_depth_picture_of_nothing_is_white():
    assert (np.array(depth_picture(np.zeros((2, 3)))) == 255).all()
