import math

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import SiteError
from elbowroom.geometry import looking_at
from elbowroom.sensing import Margin, NoiseModel
from elbowroom.site import Site
from elbowroom.site.notes import notes_of
from elbowroom.site.paths import existing_folder, expand
from elbowroom.site.site import NEW_SITE


def test_a_plain_site_is_its_values(folder, plain):
    site = Site.load(folder.write(plain))
    assert site.grid().shape == (20, 20, 10)
    assert [camera.name for camera in site.cameras()] == ["north", "south"]
    assert site.cameras()[0].width == 8 and site.cameras()[1].intrinsics.cy == 2.5
    assert site.machine() is None
    assert site.margin() == Margin()
    assert (site.rule, site.detail) == ("three", "pixel")
    assert site.depth_scale_m("north") == 0.001
    assert notes_of(site) == ("max_frame_age_ms is not given: frames of any age count",)


def test_a_cameras_own_keys_go_before_the_shared_ones(folder, plain):
    plain["camera_defaults"] |= {"noise": "tof", "margin": {"bias_m": 0.01}, "max_depth_m": 5.0}
    plain["cameras"][1] |= {
        "noise": "exact",
        "fx": 4,
        "fy": 5.0,
        "cx": 3.0,
        "cy": 2.0,
        "depth_kind": "radial",
    }
    north, south = Site.load(folder.write(plain)).cameras()
    assert north.noise == NoiseModel(0.0015, 0.0, 0.00025)
    assert north.margin == Margin(bias_m=0.01) == south.margin
    assert south.noise is None and south.intrinsics.fx == 4.0 and south.depth_kind == "radial"
    assert north.max_depth_m == south.max_depth_m == 5.0
    assert (north.flying_pixels, south.flying_pixels) == (True, False)


def test_noise_and_margin_in_numbers(folder, plain):
    plain["camera_defaults"]["noise"] = {"constant_m": 0.001, "quadratic": 0.002, "offset_m": 0.4}
    plain["margin"] = {"sigmas": 2, "range_quadratic": 0.003}
    site = Site.load(folder.write(plain))
    assert site.cameras()[0].noise == NoiseModel(0.001, 0.0, 0.002, 0.4)
    assert site.margin() == Margin(sigmas=2.0, range_quadratic=0.003)


def test_intrinsics_and_pose_from_files(folder, plain):
    (folder.path / "K.txt").write_text("8 0 3.5\n0 9 2.5\n0 0 1\n")
    (folder.path / "pose.txt").write_text("1 0 0 0.25\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    plain["cameras"] = [{"name": "north", "pose_file": "pose.txt", "intrinsics_file": "K.txt"}]
    (camera,) = Site.load(folder.write(plain)).cameras()
    assert camera.intrinsics.fy == 9.0
    assert camera.centre_in_world.tolist() == [0.25, 0.0, 0.0]


def test_grid_by_shape_and_with_another_voxel_size(folder, plain):
    plain["grid"] = {"origin_m": [0, 0, 0], "shape": [10, 20, 30], "voxel_size_m": 0.1}
    site = Site.load(folder.write(plain))
    assert site.grid().shape == (10, 20, 30)
    assert site.grid(0.05).shape == (20, 40, 60)
    with pytest.raises(SiteError, match="voxel_size_m is -1"):
        site.grid(-1.0)


coordinate = st.floats(-5, 5)


@given(
    eye=st.tuples(coordinate, coordinate, coordinate), target=st.tuples(coordinate, coordinate, coordinate)
)
def test_a_camera_that_looks_at_a_point_has_it_in_the_middle_and_stands_upright(eye, target):
    distance = math.dist(eye, target)
    if distance < 1e-3:
        return
    pose = looking_at(eye, target)
    rotation = pose[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    np.testing.assert_allclose(rotation.T @ (np.array(target) - eye), [0, 0, distance], atol=1e-6)
    # y points down in the image and in the world; x stays level
    assert rotation[2, 1] <= 1e-6 and abs(rotation[2, 0]) <= 1e-6


def test_a_camera_that_looks_straight_down_is_allowed():
    pose = looking_at((0, 0, 3), (0, 0, 0))
    np.testing.assert_allclose(pose[:3, 2], (0, 0, -1), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)


def test_paths_take_variables_of_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("ROOM_DATA", "/data")
    monkeypatch.delenv("NO_SUCH", raising=False)
    assert str(expand("${ROOM_DATA}/a", tmp_path)) == "/data/a"
    assert expand("${NO_SUCH:-../other}/a", tmp_path) == tmp_path.parent / "other" / "a"
    assert expand("plain/a", tmp_path) == tmp_path / "plain" / "a"
    with pytest.raises(SiteError, match=r"\$\{NO_SUCH\} is not set"):
        expand("${NO_SUCH}/a", tmp_path)
    with pytest.raises(SiteError, match=r"variables are written"):
        expand("${not a name}/a", tmp_path)


def test_a_variable_that_is_relative_is_so_to_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.setenv("ROOM_DATA", "recordings")
    monkeypatch.chdir(tmp_path)
    assert expand("${ROOM_DATA}/a", tmp_path / "examples") == tmp_path / "recordings" / "a"


@pytest.mark.parametrize("kind", ["planar", "floating"])
def test_a_machine_on_a_free_base_has_its_place_among_its_joints(folder, plain, arm_urdf, kind):
    plain["machine"] = {"urdf": arm_urdf.name, "free_base": kind}
    machine = Site.load(folder.write(plain)).machine()
    assert machine is not None
    assert machine.joint_names[0] == "base/x" and ("base/z" in machine.joint_names) == (kind == "floating")


def test_a_machine_with_braking_distances_of_its_joints(folder, plain, arm_urdf):
    plain["machine"] = {"urdf": arm_urdf.name, "unchecked_links": ["base"], "explain_tolerance_m": 0.03}
    plain["joints"] = {
        "slide": {"max_speed_m_s": 0.2, "braking_time_s": 0.5},
        "turn": {"max_speed_deg_s": 90, "braking_time_s": 0.1},
    }
    site = Site.load(folder.write(plain))
    machine = site.machine()
    assert machine is site.machine()
    assert site.explain_tolerance_m == 0.03
    motions = {(motion.joint, motion.direction): motion.braking_distance for motion in site.motions(machine)}
    assert list(motions) == [("turn", 1), ("turn", -1), ("slide", 1), ("slide", -1)]
    assert motions["slide", 1] == pytest.approx(0.05)
    assert motions["turn", -1] == pytest.approx(math.radians(4.5))
    assert "links that are not checked: base" in notes_of(site)


def test_joints_without_a_speed_are_named(folder, plain, arm_urdf):
    plain["machine"] = {"urdf": arm_urdf.name}
    plain["joints"] = {"slide": {"max_speed_m_s": 0.2, "braking_time_s": 0.5}}
    plain["max_frame_age_ms"] = 100
    site = Site.load(folder.write(plain))
    assert len(site.motions(site.machine())) == 2
    assert notes_of(site) == ("joints without a speed, whose motions are not checked: turn",)


def test_a_pose_a_little_off_is_mended_and_noted(folder, plain):
    plain["cameras"][0]["world_from_camera"] = (np.diag([1.0005, 1, 1, 1])).tolist()
    plain["max_frame_age_ms"] = 100
    site = Site.load(folder.write(plain))
    assert site.max_age_ns == 100_000_000
    rotation = site.cameras()[0].world_from_camera[:3, :3]
    np.testing.assert_allclose(rotation, np.eye(3), atol=1e-12)
    assert (
        len(notes_of(site)) == 1
        and "north: world_from_camera: off a rotation by 5.0e-04" in notes_of(site)[0]
    )


def test_rules_that_break_the_law_are_noted(folder, plain):
    for rule, said in (("three", False), ("majority", False), ("veto", True), ("any", True)):
        plain["rule"] = rule
        notes = notes_of(Site.load(folder.write(plain)))
        assert any("less evidence may add free space" in note for note in notes) == said


def test_the_simulated_room_says_how_its_cameras_are_made():
    site = Site.simulated_room()
    settings = site.simulated_cameras()
    assert (settings["count"], set(settings["height_m"]), settings["optics"].hfov_deg) == (
        21,
        {2.4, 0.4},
        90.0,
    )
    assert site.max_age_ns == 200_000_000
    assert {motion.joint for motion in site.motions(site.machine())} == {"long", "larm", "propeller", "carc"}
    motions = {motion.name: motion.braking_distance for motion in site.motions(site.machine())}
    # thesis 4.1: 0.15 m/s, 12, 25, 25 degrees a second, 0.5 s
    assert motions["long +"] == pytest.approx(0.0375)
    assert motions["larm -"] == pytest.approx(math.radians(3))
    assert motions["carc +"] == motions["propeller +"] == pytest.approx(math.radians(6.25))
    with pytest.raises(SiteError, match="its cameras are made by the simulator"):
        site.cameras()


def test_a_real_room_is_not_simulated(folder, plain):
    with pytest.raises(SiteError, match="not a simulated room"):
        Site.load(folder.write(plain)).simulated_cameras()


def test_the_new_site_is_valid_and_so_are_the_keys_that_it_shows_in_comments(folder):
    text = NEW_SITE.read_text()
    site = Site.load(folder.write(text))
    assert len(site.cameras()) == 2 and len(site.motions(site.machine())) == 8
    # turn on the commented single-line settings that have no rival in the file
    for key in ("distortion", "noise", "margin", "flying_pixels", "unchecked_links", "explain_tolerance_m"):
        line = next(line for line in text.splitlines() if line.strip().startswith(f"# {key}:"))
        assert yaml.safe_load(line.strip().removeprefix("# "))[key]
    start = text.index("# recording:")
    block = "\n".join(line.removeprefix("# ") for line in text[start:].splitlines()[:4])
    content = yaml.safe_load(text) | yaml.safe_load(block)
    assert Site.load(folder.write(content)).has_stamps
    gate = "\n".join(line.removeprefix("# ") for line in text[text.index("# gate:") :].splitlines())
    site = Site.load(folder.write(content | yaml.safe_load(gate)))
    assert site.entry.gate is not None and site.entry.gate.modbus.port == 5020


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("~/rec", "write ${HOME}"),
        ("$HOME/rec", "written ${HOME}"),
        ("%USERPROFILE%/rec", "written ${USERPROFILE}"),
        ("..\\rec", "write / for"),
        ("file:///data/rec", "without what stands before"),
    ],
)
def test_paths_that_another_program_would_read_are_told_what_to_write(tmp_path, text, words):
    with pytest.raises(SiteError) as error:
        existing_folder(text, tmp_path)
    assert words in str(error.value)
