"""Images that read as valid and cannot be meant so are named; those that are right are passed in silence."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import FrameError
from elbowroom.evaluate.looks.wrong import WRONG
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.values import look_at_images
from reference import values_room as room

OF_IMAGES = [
    name
    for name in WRONG
    if not any(word in name for word in ("lens", "poses", "focal", "cx and cy", "all one number"))
]


@pytest.mark.parametrize("unit_m", [0.001, 0.0002, 0.00025])
@pytest.mark.parametrize("noise_m", [0.0, 0.003])
def test_a_room_as_it_is_is_passed_in_silence(unit_m, noise_m):
    assert room.scene(unit_m, noise_m).findings() == ()


def test_floats_without_a_unit_are_passed_in_silence():
    frames = [DepthFrame(camera.name, 0, room.depth_of(camera)) for camera in room.cameras()]
    assert look_at_images(room.GRID, room.cameras(), frames) == ()


@pytest.mark.parametrize("kind", OF_IMAGES)
@pytest.mark.parametrize("noise_m", [0.0, 0.003])
def test_each_kind_of_wrong_image_is_named_and_stops(kind, noise_m):
    wrong = WRONG[kind]
    changed = wrong.change(room.scene(noise_m=noise_m), np.random.default_rng(1))
    try:
        findings = changed.findings()
    except FrameError as error:
        assert "metres" in str(error)
        return
    assert any(finding.stops for finding in findings)
    assert not wrong.kinds or any(finding.kind in wrong.kinds for finding in findings)
    for finding in findings:
        assert "\n" not in finding.text and len(finding.text) < 500
        assert set(finding.about) <= {camera.name for camera in room.cameras()}


@pytest.mark.parametrize("camera", sorted(room.EYES))
def test_one_camera_with_a_sentinel_is_named_alone(camera):
    scene = room.scene(noise_m=0.002)
    codes = {
        name: np.where(raw > 4000, 9000, raw) if name == camera else raw for name, raw in scene.codes.items()
    }
    findings = replace(scene, codes=codes).findings()
    assert [(finding.kind, finding.about, finding.stops) for finding in findings] == [
        ("sentinel", (camera,), True)
    ]
    assert "exactly 9 m (raw 9000)" in findings[0].text and "max_depth_m: 9" in findings[0].text


def test_the_greatest_range_itself_is_said_and_harmless():
    scene = room.scene(max_depth_m=10.0)
    codes = {name: np.where(raw > 3500, 10000, raw) for name, raw in scene.codes.items()}
    findings = replace(scene, codes=codes).findings()
    assert [finding.stops for finding in findings] == [False]
    assert "max_depth_m: taken as no return" in findings[0].text


def test_a_floor_seen_from_straight_above_is_no_sentinel():
    """Without noise all of the floor has one depth, the greatest of the image."""
    camera = room.camera_at("top", (0.0, 0.0, 2.5), (0.0, 0.0, 0.0))
    depth = room.depth_of(camera)
    assert (depth == depth.max()).mean() > 0.1
    assert look_at_images(room.GRID, [camera], [DepthFrame("top", 0, depth)]) == ()


def test_an_exact_number_amid_one_image_alone_may_be_a_surface_and_of_two_is_none():
    """A plate before one camera, square to it and exact, has one depth all over; two cameras have none in common."""
    for names, told in ((("ne",), ()), (("ne", "sw"), ("ne", "sw"))):
        scene = room.scene(noise_m=0.003)
        codes = {name: raw.copy() for name, raw in scene.codes.items()}
        for name in names:
            codes[name][21:60, 31:90] = 1500
        found = replace(scene, codes=codes).findings()
        assert tuple(name for each in found if each.kind == "sentinel" for name in each.about) == told


def test_a_wall_that_fills_the_image_is_one_only_for_a_camera_that_faces_it():
    facing = room.camera_at("one", (0.0, 0.0, 1.4), (1.0, 0.0, 1.4))
    assert look_at_images(room.GRID, [facing], [DepthFrame("one", 0, np.full((120, 160), 1.8))]) == ()
    camera = room.camera_at("one", (0.0, 0.0, 1.4), (1.0, 0.3, 1.2))
    found = look_at_images(room.GRID, [camera], [DepthFrame("one", 0, np.full((120, 160), 1.8))])
    assert [(finding.kind, finding.stops) for finding in found] == [("constant", False)]


def test_no_returns_at_all_stop_and_those_of_one_camera_do_not():
    scene = room.scene()
    black = {name: raw * 0 for name, raw in scene.codes.items()}
    assert [finding.stops for finding in replace(scene, codes=black).findings()] == [True]
    one = {**scene.codes, "ne": black["ne"]}
    assert [(f.about, f.stops) for f in replace(scene, codes=one).findings()] == [(("ne",), False)]


@pytest.mark.parametrize(
    ("said", "meant"), [(0.001, 0.00025), (0.001, 0.0001), (0.001, 0.01), (0.0001, 0.001)]
)
def test_the_unit_that_fits_is_suggested(said, meant):
    true = room.scene(unit_m=meant)
    (finding,) = replace(true, units_m=dict.fromkeys(true.units_m, said)).findings()
    assert finding.kind == "unit" and finding.about == tuple(room.EYES)
    if meant != 0.01:
        assert f"with depth_scale_m {meant:g}" in finding.text


def test_shifted_bits_are_named_as_such():
    scene = room.scene()
    shifted = {name: (raw.astype(int) * 8).astype(np.uint16) for name, raw in scene.codes.items()}
    (finding,) = replace(scene, codes=shifted).findings()
    assert "bits are shifted: divide the raw values by 8" in finding.text


def test_disparity_is_told_from_depth_by_straight_surfaces_alone():
    """In a unit by which it lies where depth would, so that no range tells."""
    scene = room.scene(noise_m=0.001)
    median = {name: np.median(raw) for name, raw in scene.codes.items()}
    turned = {name: np.rint(median[name] ** 2 / raw).astype(np.uint16) for name, raw in scene.codes.items()}
    assert "disparity" in {finding.kind for finding in replace(scene, codes=turned).findings()}
