import numpy as np
import pytest

from elbowroom.simulate.shapes import box
from elbowroom.simulate.solid import Mesh, Solid
from elbowroom.view.picture.fixed import room_layer
from elbowroom.view.picture.layer import Layer, Lines, Subject, Word
from elbowroom.view.picture.light import cast
from elbowroom.view.picture.overlay import draw_lines, draw_words
from elbowroom.view.picture.picture import picture_of, save_picture
from elbowroom.view.picture.viewpoint import looking, standard

SIZE = (96, 72)


def block(lower, upper) -> np.ndarray:
    vertices, faces = box(lower, upper)
    return vertices[faces]


def wall(x, colour=(0.5, 0.5, 0.5), opacity=1.0) -> Layer:
    """Across all of a view from the origin along x."""
    return Layer.plain(block((x, -20, -20), (x + 0.1, 20, 20)), colour, opacity)


VIEW = looking((0, 0, 0), (1, 0, 0), SIZE)


def test_nothing_is_white_and_infinitely_far() -> None:
    light = cast([], VIEW)
    assert (light.rgb == 1).all() and np.isinf(light.depth_m).all()


def test_depth_is_along_the_view_at_every_pixel() -> None:
    np.testing.assert_allclose(cast([wall(3.0)], VIEW).depth_m, 3.0, rtol=1e-5)


def test_what_is_behind_changes_nothing() -> None:
    far = Layer.plain(block((6, -1, -1), (7, 1, 1)), (1, 0, 0))
    veil = Layer.plain(block((6, -1, -1), (7, 1, 1)), (1, 0, 0), 0.5)
    alone = cast([wall(3.0)], VIEW).rgb
    for behind in (far, veil):
        np.testing.assert_allclose(cast([wall(3.0), behind], VIEW).rgb, alone, atol=1e-6)


def test_a_veil_lets_its_share_through_in_any_order() -> None:
    behind, red, green = wall(3.0), wall(2.0, (1, 0, 0), 0.5), wall(1.0, (0, 1, 0), 0.5)
    middle = [cast(layers, VIEW).rgb[36, 48] for layers in ([behind, red, green], [green, behind, red])]
    np.testing.assert_allclose(*middle)
    back = cast([behind], VIEW).rgb[36, 48]
    # half of the green before a quarter of the red before a quarter of the wall
    assert middle[0][1] > middle[0][0] > middle[0][2] == pytest.approx(back[2] / 4, rel=0.01)


def test_edges_of_things_are_smooth_and_lined() -> None:
    cube = Layer.plain(block((2, -0.5, -0.5), (3, 0.5, 0.5)), (0.9, 0.9, 0.9))
    row = cast([cube], VIEW).rgb[36, :, 0]
    assert row[48] > 0.4 and row[2] == 1
    assert row.min() < 0.9 * row[48]


def test_a_wall_is_cut_away_before_who_looks_from_outside_only() -> None:
    walls = np.array([[0.0, 0, 0], [4, 4, 3]])
    mesh = {
        "wall -y": block((-0.2, -0.2, -0.2), (4.2, 0, 3.2)),
        "ceiling": block((-0.2, -0.2, 3), (4.2, 4.2, 3.2)),
        "cabinet": block((1, 0, 0), (2, 0.3, 2)),
    }
    faces = np.arange(36).reshape(-1, 3)
    solids = [Solid(name, Mesh(part.reshape(-1, 3), faces), np.eye(4)) for name, part in mesh.items()]
    outside = looking((2, -5, 1), (2, 2, 1), SIZE)
    inside = looking((2, 3, 1), (2, 0, 1), SIZE)
    assert set(room_layer(solids, walls, inside).thing) == {0, 1, 2}
    assert set(room_layer(solids, walls, outside).thing) == {1, 2}
    assert set(room_layer(solids, walls, standard("top", walls, SIZE)).thing) == {0, 2}
    assert set(room_layer(solids, None, outside).thing) == {0, 1, 2}


def test_what_of_a_line_is_hidden_is_faint() -> None:
    light = cast([Layer.plain(block((2, -9, -9), (2.1, 0, 9)), (0.9, 0.9, 0.9))], VIEW)
    subject = Subject((), (Lines(np.array([[[3.0, -1.5, 0.0], [3.0, 1.5, 0.0]]]), (0, 0, 0), 2.0),))
    blank = picture_of(Subject(()), VIEW).crop((0, 0, *SIZE))
    dark = 255 - np.array(draw_lines(blank, subject.lines, VIEW, light.depth_m).convert("L")).min(axis=0)
    # y < 0 is to the right
    assert dark[30] > 200 and 20 < dark[66] < 100


def test_names_do_not_lie_on_each_other() -> None:
    blank = picture_of(Subject(()), VIEW).crop((0, 0, *SIZE))
    one = blank.copy()
    draw_words(one, [Word("cam", (3.0, 0.0, 0.0), (0, 0, 0))], VIEW)
    many = blank.copy()
    draw_words(many, [Word("cam", (3.0, 0.0, 0.0), (0, 0, 0)) for _ in range(50)], VIEW)
    ink = [int((np.array(p.convert("L")) < 128).sum()) for p in (one, many)]
    assert 0 < ink[0] < ink[1] <= 4 * ink[0]


def test_a_picture_has_legend_and_title_and_is_written_whole(tmp_path) -> None:
    subject = Subject((wall(3.0),), legend=(((10, 20, 200), "unseen"),), title="room")
    picture = picture_of(subject, VIEW)
    assert picture.width == SIZE[0] and picture.height > SIZE[1]
    assert (np.array(picture).reshape(-1, 3) == (10, 20, 200)).all(axis=1).any()
    path = save_picture(picture, tmp_path / "a.png")
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"] and path.stat().st_size > 100
