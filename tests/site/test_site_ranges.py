"""Numbers that the field does not allow are refused, with the unit that they most likely are in."""

import json

import pytest
import yaml

from elbowroom.errors import SiteError
from elbowroom.site import Site
from elbowroom.site.notes import notes_of
from elbowroom.site.site import NEW_SITE

SITE = {
    "grid": {"origin_m": [-1, -1, 0], "upper_m": [1, 1, 2], "voxel_size_m": 0.1},
    "camera_defaults": {"width": 160, "height": 120, "fx": 80.0, "fy": 80.0, "cx": 79.5, "cy": 59.5},
    "cameras": [{"name": "a", "position_m": [-1, 0, 1], "look_at_m": [0, 0, 1]}],
    "machine": {"builtin": "ceiling_c_arm"},
    "joints": {"long": {"max_speed_m_s": 0.15, "braking_time_s": 0.5}},
    "calibration": {"board": {"columns": 8, "rows": 5, "square_m": 0.1, "kind": "cut_out"}},
}


def load(tmp_path, path, value):
    content = json.loads(json.dumps(SITE))
    inner = content
    *parents, last = path.split(".")
    for key in parents:
        inner = inner[int(key)] if key.isdigit() else inner.setdefault(key, {})
    inner[last] = value
    (tmp_path / "site.yaml").write_text(yaml.safe_dump(content))
    return Site.load(tmp_path / "site.yaml")


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("camera_defaults.depth_scale_m", 1000.0, r"units a metre, .* write 0\.001"),
        ("camera_defaults.depth_scale_m", 5000, r"write 0\.0002"),
        ("camera_defaults.depth_scale_m", 1.0, r"0\.001 for millimetres"),
        ("camera_defaults.depth_scale_m", 0.1, r"to 0\.01 metres a unit"),
        ("camera_defaults.depth_scale_m", 1e-7, "metres a unit"),
        ("camera_defaults.depth_bias_m", 12.0, "looks like millimetres: 0.012"),
        ("camera_defaults.fy", -80.0, r"greater than 0; .*diag\(1, -1, 1, 1\).* fy: 80"),
        ("camera_defaults.fx", -80.0, r"diag\(-1, 1, 1, 1\).* fx: 80"),
        ("camera_defaults.max_depth_m", 8000, "looks like millimetres: 8"),
        ("camera_defaults.min_depth_m", 400, "looks like millimetres: 0.4"),
        ("camera_defaults.noise", {"constant_m": 1.5}, "looks like millimetres: 0.0015"),
        ("margin.bias_m", 10, "looks like millimetres: 0.01"),
        ("margin.range_linear", 1.5, "looks like percent: 0.015"),
        ("margin.sigmas", 1000, "at most 100 standard deviations"),
        ("margin.lateral_px", 500, "at most 100 pixels"),
        ("grid.voxel_size_m", 50, "looks like millimetres: 0.05"),
        ("grid.voxel_size_m", 5, "looks like centimetres: 0.05"),
        ("grid.upper_m", [1000, 1000, 2000], "most likely it is in millimetres"),
        ("joints.long.max_speed_m_s", 150, "looks like millimetres a second: 0.15"),
        ("joints.long.braking_time_s", 500, "looks like milliseconds: 0.5"),
        ("max_frame_age_ms", 0.2, "looks like seconds: 200"),
        ("pass_time_ms", 0.1, "looks like seconds: 100"),
        ("people_speed_m_s", 1600, "looks like millimetres a second: 1.6"),
        ("people_speed_m_s", 15, "looks like kilometres an hour: 4.16667"),
        ("people_speed_m_s", 0.1, "0.5 to 10 m/s"),
        ("people_speed_m_s", 0, "nothing_moves"),
        ("nothing_moves", True, "people_speed_m_s 0 alone"),
        ("camera_defaults.clock_bound_ms", 5e6, "looks like nanoseconds: 5"),
        ("machine.explain_tolerance_m", 10, "looks like millimetres: 0.01"),
        ("calibration.board.square_m", 90, "looks like millimetres: 0.09"),
    ],
)
def test_what_the_field_does_not_allow_is_refused_with_its_likely_unit(tmp_path, path, value, says):
    with pytest.raises(SiteError, match=says) as caught:
        load(tmp_path, path, value)
    text = str(caught.value)
    assert path.split(".")[0] in text and "\n" not in text and len(text) < 500


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("camera_defaults.depth_scale_m", unit)
        for unit in (0.001, 0.0002, 0.00025, 0.0001, 1 / 256, 0.000125, 0.01)
    ]
    + [
        ("camera_defaults.max_depth_m", 80.0),
        ("grid.voxel_size_m", 0.005),
        ("grid.voxel_size_m", 0.5),
        ("joints.long.max_speed_m_s", 3.0),
        ("max_frame_age_ms", 1),
        ("calibration.board.square_m", 0.02),
    ],
)
def test_what_is_in_use_is_allowed(tmp_path, path, value):
    load(tmp_path, path, value)


def test_the_site_that_one_starts_from_is_allowed():
    Site.load(NEW_SITE)


def test_how_fast_people_are_and_what_a_clock_may_be_off_are_said_by_the_site(tmp_path):
    site = load(tmp_path, "camera_defaults.clock_bound_ms", 5.0)
    assert site.terms().people_speed_m_s == 2.0 and site.terms().pass_ns == 0
    assert [camera.clock_bound_ns for camera in site.cameras()] == [5_000_000]
    assert load(tmp_path, "people_speed_m_s", 1.6).terms().people_speed_m_s == 1.6
    assert load(tmp_path, "pass_time_ms", 80).terms().pass_ns == 80_000_000


def test_a_room_where_nothing_moves_says_so_in_every_summary(tmp_path):
    site = Site.load(load(tmp_path, "people_speed_m_s", 1.6).path)
    assert not any("nothing_moves" in note for note in notes_of(site))
    content = yaml.safe_load(site.path.read_text())
    site.path.write_text(yaml.safe_dump({**content, "people_speed_m_s": 0, "nothing_moves": True}))
    (still,) = Site.load(site.path).terms().allowances
    assert still.startswith("nothing but the machine moves here")
    assert still in notes_of(Site.load(site.path))
