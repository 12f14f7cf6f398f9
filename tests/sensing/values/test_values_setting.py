"""Lenses that cannot be those of their images, and poses that put cameras where none hangs."""

import re
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.sensing.values import look_at_setting
from elbowroom.sensing.values.lens import look_at_lens
from elbowroom.sensing.values.scatter import look_at_scatter
from reference import values_room as room

AZURE = (3.13, 2.32, 8.0e-05, -5.0e-05, 0.13, 3.46, 3.35, 0.66)
"""k1 k2 p1 p2 k3 k4 k5 k6, about as a rational lens of a time-of-flight camera has them."""


def kinds(cameras, grid=room.GRID):
    return {(finding.kind, finding.stops) for finding in look_at_setting(grid, cameras)}


def with_lens(width=160, height=120, **lens):
    k = Intrinsics(**{"fx": 80.0, "fy": 80.0, "cx": width / 2 - 0.5, "cy": height / 2 - 0.5, **lens})
    return DepthCamera("one", width, height, looking_at((1.8, 1.8, 2.4), (0.0, 0.0, 0.8)), k)


def test_a_pose_that_two_cameras_have_is_said_and_one_that_is_nearly_so_is_not():
    one, other, *rest = room.cameras()
    copied = (one, replace(other, world_from_camera=one.world_from_camera), *rest)
    (found,) = look_at_setting(room.GRID, copied)
    assert (found.about, found.stops) == ((one.name, other.name), False) and "copied" in found.text
    beside = one.world_from_camera.copy()
    beside[0, 3] += 0.01
    assert look_at_setting(room.GRID, (one, replace(other, world_from_camera=beside), *rest)) == ()


def test_what_is_right_is_passed_in_silence():
    assert look_at_setting(room.GRID, room.cameras()) == ()


@pytest.mark.parametrize(
    ("width", "height", "fx", "cx", "cy"),
    [
        (640, 576, 504.0, 321.3, 334.9),
        (640, 480, 383.0, 318.2, 237.5),
        (848, 480, 425.0, 423.9, 240.1),
        (512, 424, 365.5, 257.4, 208.3),
        (640, 480, 572.0, 314.6, 241.0),
        (1280, 720, 640.0, 651.0, 355.0),
        (224, 172, 212.0, 110.0, 88.0),
        (1024, 1024, 505.0, 512.0, 519.0),
    ],
)
def test_lenses_of_sensors_in_use_are_passed_in_silence(width, height, fx, cx, cy):
    assert kinds([with_lens(width, height, fx=fx, fy=fx, cx=cx, cy=cy)]) == set()


@pytest.mark.parametrize(
    ("lens", "kind", "stops", "says"),
    [
        ({"fx": 160.0, "fy": 160.0, "cx": 159.5, "cy": 119.5}, "principal point", True, "about 320 x 240"),
        ({"fx": 40.0, "fy": 40.0, "cx": 39.5, "cy": 29.5}, "principal point", True, "fx is 80, fy 80"),
        ({"cx": 59.5, "cy": 79.5}, "principal point", True, "exchanged"),
        ({"cx": 30.0}, "principal point", False, "middle half"),
        ({"cx": 400.0}, "principal point", True, "middle half"),
        ({"fx": 0.5, "fy": 0.667, "cx": 0.5, "cy": 0.5}, "field of view", True, "size 1: .* fx is 80"),
        ({"fx": 1.93, "fy": 1.93}, "field of view", True, "in millimetres"),
        ({"fx": 4000.0, "fy": 4000.0}, "field of view", True, "sees so little"),
        ({"fx": 80.0, "fy": 140.0}, "focal length", False, "square"),
    ],
)
def test_lenses_of_other_images_are_named(lens, kind, stops, says):
    (finding,) = look_at_setting(room.GRID, [with_lens(**lens)])
    assert (finding.kind, finding.stops) == (kind, stops)
    assert re.search(says, finding.text)


def test_coefficients_in_another_order_are_named_with_the_order_that_fits():
    k1, k2, p1, p2, k3, k4, k5, k6 = AZURE
    lens = {"fx": 126.0, "fy": 126.0, "cx": 83.0, "cy": 81.5}
    right = with_lens(160, 144, **lens, distortion=AZURE)
    assert {stops for _, stops in kinds([right])} <= {False}
    maker = with_lens(160, 144, **lens, distortion=(k1, k2, k3, k4, k5, k6, p2, p1))
    (finding,) = look_at_setting(room.GRID, [maker])
    assert finding.stops and "in the order k1 k2 k3 k4 k5 k6 p2 p1" in finding.text


def test_five_coefficients_with_the_tangential_ones_last_are_named():
    barrel = with_lens(distortion=(-0.3, 0.12, -0.09, 0.001, -0.0008))
    (finding,) = look_at_setting(room.GRID, [barrel])
    assert finding.stops and "k1 k2 k3 p1 p2" in finding.text


def test_the_part_of_a_wide_lens_that_is_not_used_is_said():
    wide = DepthCamera(
        "top",
        160,
        160,
        looking_at((0.0, 0.0, 2.5), (0.0, 0.0, 0.0)),
        Intrinsics(78.75, 78.75, 79.5, 79.5, AZURE),
    )
    (finding,) = look_at_setting(room.GRID, [wide])
    assert (finding.kind, finding.stops) == ("wide lens", False) and "46%" in finding.text


@pytest.mark.parametrize(
    ("factor", "unit"), [(1000, "millimetres"), (100, "centimetres"), (1 / 0.0254, "inches")]
)
def test_poses_in_another_unit_are_named(factor, unit):
    moved = []
    for camera in room.cameras():
        pose = camera.world_from_camera.copy()
        pose[:3, 3] *= factor
        moved.append(replace(camera, world_from_camera=pose))
    (finding,) = look_at_setting(room.GRID, moved)
    assert finding.stops and finding.kind == "pose" and unit in finding.text


def test_a_camera_beyond_its_range_from_the_grid_is_named():
    away = room.camera_at("away", (9.0, 0.0, 1.0), max_depth_m=5.0)
    assert kinds([away]) == {("pose", False)}


@pytest.mark.parametrize(
    ("housing", "says"),
    [
        (np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]), "housing"),
        (np.diag([1.0, -1, -1]), "OpenGL"),
    ],
)
def test_a_camera_that_sees_nothing_is_named_with_the_frame_that_shows_most(housing, says):
    turned = []
    for camera in room.cameras():
        pose = camera.world_from_camera.copy()
        pose[:3, :3] = pose[:3, :3] @ housing
        turned.append(replace(camera, world_from_camera=pose))
    (finding,) = look_at_setting(room.GRID, turned)
    assert finding.stops and finding.kind == "view" and says in finding.text
    one = look_at_setting(room.GRID, [turned[0], *room.cameras()[1:]])
    assert [(finding.about, finding.stops) for finding in one] == [(("ne",), False)]


@pytest.mark.parametrize(
    ("cx", "cy", "said"), [(419.5, 239.5, "cx"), (319.5, 179.5, "cy"), (330.0, 250.0, "")]
)
def test_one_side_of_an_image_that_was_cut_or_squeezed_is_said(cx, cy, said):
    camera = DepthCamera("c", 640, 480, np.eye(4), Intrinsics(400, 400, cx, cy))
    found = look_at_lens(camera)
    assert [finding.stops for finding in found] == ([False] if said else [])
    assert not said or f"subtract where the cut begins from {said}" in found[0].text


@pytest.mark.filterwarnings("error")
def test_infinity_beside_infinity_is_passed_in_silence():
    camera = DepthCamera("c", 160, 120, np.eye(4), Intrinsics(80, 80, 79.5, 59.5))
    depth = np.full((120, 160), 2.0, np.float32)
    depth[:, 80:] = np.inf
    assert look_at_scatter([camera], [DepthFrame("c", 0, depth)], Margin()) == ()
