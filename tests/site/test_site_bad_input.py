# ruff: noqa: E501  (tables of one case a line)
"""Whatever is wrong with a site file is one line: the thing, what was found, what is allowed."""

import copy

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import GridError, InputError, SiteError
from elbowroom.geometry import VoxelGrid
from elbowroom.site import Site
from elbowroom.site.memory import require_memory
from elbowroom.site.site import NEW_SITE


def refusal(path, use=lambda site: site.cameras()):
    """The error's one line, which names the file."""
    with pytest.raises(InputError) as caught:
        use(Site.load(path))
    text = str(caught.value)
    assert "\n" not in text and len(text) < 500
    assert text.startswith(str(path))
    return text.removeprefix(f"{path}: ")


def changed(site, keys, value):
    """The same site with one value at another place; None takes the key away."""
    inner = site
    for key in keys[:-1]:
        inner = inner[key]
    if value is None:
        del inner[keys[-1]]
    else:
        inner[keys[-1]] = value
    return site


NAN = float("nan")
POSE = np.eye(4).tolist()


@pytest.mark.parametrize(
    ("keys", "value", "expected"),
    [
        # zero focal length and other numbers that no camera has
        (["camera_defaults", "fx"], 0, "camera_defaults.fx: found 0, allowed: greater than 0"),
        (["camera_defaults", "fy"], NAN, "camera_defaults.fy: found nan, allowed: a finite number"),
        (["camera_defaults", "width"], 0, "camera_defaults.width: found 0, allowed: greater than or equal to 1"),
        (["camera_defaults", "width"], "640", "camera_defaults.width: found '640', allowed: a valid integer"),
        (["camera_defaults", "width"], True, "camera_defaults.width: found True, allowed: a valid integer"),
        (["camera_defaults", "width"], 20000, "cameras[0] (north): camera north: width is 20000, must be 1 to 16384"),
        (["camera_defaults", "cx"], None, "cameras[0] (north): cx not given; needed here or in camera_defaults"),
        (["camera_defaults", "distortion"], [0.1, 0.2], "distortion of no coefficient, 5 (k1"),
        (["camera_defaults", "depth_kind"], "flat", "found 'flat', allowed: 'planar' or 'radial'"),
        (["camera_defaults", "depth_scale_m"], 0, "depth_scale_m: found 0, allowed: greater than 0"),
        (["camera_defaults", "noise"], "kinect", "noise: found 'kinect', allowed: exact, kinect_v1"),
        (["camera_defaults", "noise"], {"constant": 1}, "noise.constant: unknown key (did you mean constant_m?)"),
        (["camera_defaults", "margin"], {"bias_m": -1}, "margin.bias_m: found -1, allowed: greater than or equal to 0"),
        (["camera_defaults", "min_depth_m"], 9, None),
        (["camera_defaults", "intrinsics_file"], "K.txt", "either intrinsics_file or fx, fy, cx, cy, not both"),
        # poses
        (["cameras", 0, "world_from_camera", 0, 3], NAN, "cameras[0].world_from_camera[0][3]: found nan, allowed: a fin"),
        (["cameras", 0, "world_from_camera", 0, 2], 1.01, "cameras[0] (north): camera north: world_from_camera: not rigid"),
        (["cameras", 0, "world_from_camera"], POSE[:3], "cameras[0].world_from_camera[3]: missing"),
        (["cameras", 0, "world_from_camera"], None, "exactly one of world_from_camera, pose_file, or position_m"),
        (["cameras", 0, "pose_file"], "p.txt", "exactly one of world_from_camera, pose_file, or position_m"),
        (["cameras", 1, "look_at_m"], None, "exactly one of world_from_camera, pose_file, or position_m"),
        (["cameras", 1, "look_at_m"], [1, 0, 0.5], "give no direction; they must differ"),
        # names
        (["cameras", 1, "name"], "north", "each camera a name of its own; north is there more than once"),
        (["cameras", 0, "name"], "../north", "cameras[0].name: found '../north'"),
        (["cameras", 0, "name"], None, "cameras[0].name: missing; it must be given"),
        (["cameras"], [], "at least one camera, or simulated, or a recording of layout seven_scenes"),
        # grids
        (["grid"], None, "grid: missing; it must be given"),
        (["grid", "upper_m"], [1, -1, 1], "grid: empty, upper corner [1.0, -1.0, 1.0] is not above"),
        (["grid", "voxel_size_m"], 0, "grid.voxel_size_m: found 0, allowed: greater than or equal to 0.0001"),
        (["grid", "voxel_size_m"], 1e-4, "choose larger voxels or a smaller box"),
        (["grid", "shape"], [1, 1, 1], "exactly one of upper_m and shape"),
        (["grid", "origin_m"], [0, 0], "grid.origin_m[2]: missing"),
        # unknown keys and choices
        (["rules"], "three", "rules: unknown key (did you mean rule?), allowed: name, grid"),
        (["grid", "voxel_size"], 0.1, "grid.voxel_size: unknown key (did you mean voxel_size_m?), allowed: origin_m"),
        (["cameras", 0, "focal"], 1, "cameras[0].focal: unknown key, allowed: width, height, fx"),
        (["rule"], "two", "rule: found 'two', allowed: 'three', 'majority', 'veto' or 'any'"),
        (["detail"], "fine", "detail: found 'fine', allowed: 'footprint', 'pixel' or 'point'"),
        (["max_frame_age_ms"], -1, "max_frame_age_ms: found -1, allowed: greater than 0"),
        (["joints"], {"a": {"max_speed_m_s": 1, "braking_time_s": 1}}, "joints only with a machine"),
        (["machine"], {}, "exactly one of builtin and urdf"),
        (["machine"], {"builtin": "robot"}, "machine.builtin: found 'robot', allowed: 'ceiling_c_arm'"),
        # recordings
        (["recording"], {"layout": "tape", "folder": "x"}, "allowed: a key layout with folder, stampless, seven_scenes"),
        (["recording"], {"folder": "x"}, "allowed: a key layout with folder, stampless, seven_scenes"),
        (["recording"], {"layout": "folder"}, "recording.folder: missing"),
        (["recording"], {"layout": "folder", "folder": "x", "age": 1}, "recording.age: unknown key, allowed: layout"),
        (["recording"], {"layout": "seven_scenes", "folder": "x"}, "no list of cameras where layout seven_scenes"),
        (["simulated"], {"cameras": 3}, "a list of cameras, or simulated.cameras, which makes them along the walls"),
    ],
)  # fmt: skip
def test_one_wrong_value_is_one_line(folder, plain, keys, value, expected):
    if expected is None:
        plain["camera_defaults"]["max_depth_m"] = 1.0
        expected = "is no range"
    assert expected in refusal(folder.write(changed(plain, keys, value)))


def test_several_wrong_values_are_counted(folder, plain):
    plain["camera_defaults"]["fx"] = 0
    plain["rule"] = "two"
    assert refusal(folder.write(plain)).endswith("(1 more)")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "holds NoneType, expected keys such as grid and cameras"),
        ("- 1", "holds list"),
        ("grid: [", "line 1: "),
        ("name: a\nname: b\n", "line 2: key 'name' is there twice"),
        ("grid: {origin_m: 1, origin_m: 2}", "line 1: key 'origin_m' is there twice"),
        ("a: &x 1\nb: *x\n", "line 2: alias *x"),
        ("a: !!python/object/apply:os.getcwd []", "could not determine a constructor"),
        ("? [1, 2]\n: 3\n", "is not a word"),
        ("a: 1\nb: 0200", "line 2: 0200 would be read as 128"),
        ("a: 1:30", "line 1: 1:30 would be read as 90"),
        ("a: 1_0.5", "line 1: 1_0.5 would be read as 10.5"),
        ("a: 2001-99-99", "a value cannot be read"),
        ("a: \x00", "not YAML in UTF-8"),
        ("[" * 5000, "nested too deeply"),
    ],
)
def test_text_that_is_no_site_is_one_line(folder, text, expected):
    assert expected in refusal(folder.write(text))


def test_text_in_utf_16_is_told_to_be_so(folder):
    (folder.path / "site.yaml").write_bytes("name: a\n".encode("utf-16"))
    assert "UTF-16; save it as UTF-8" in refusal(folder.path / "site.yaml")


def test_numbers_as_people_write_them_are_numbers(folder, plain):
    """Zero, decimals and exponents; a quoted name may be of digits."""
    text = folder.write(plain).read_text().replace("name: north", 'name: "01"')
    for written in ("0.1", ".1", "1e-1", "10e-2", "0.10"):
        (folder.path / "site.yaml").write_text(text.replace("voxel_size_m: 0.1", f"voxel_size_m: {written}"))
        site = Site.load(folder.path / "site.yaml")
        assert site.grid().voxel_size_m == 0.1 and site.cameras()[0].name == "01"


@pytest.mark.parametrize(
    ("keys", "value", "expected"),
    [
        (
            ["cameras", 0, "name"],
            True,
            "YAML reads on, off, yes and no as true and false: write it in quotes",
        ),
        (["cameras", 0, "name"], 1, "found 1, allowed: a valid string; write it in quotes"),
        (["cameras", 0, "name"], "..", "a name that a folder can have"),
        (["cameras", 0, "name"], "north ", "without blanks at its ends"),
        (["grid", "voxel_size_m"], "0,04", "decimals have a dot"),
        (["grid", "voxel_size_m"], "0.04", "write it without quotes"),
        (["grid", "voxel_size_m"], "4 cm", "its unit is in the key's name"),
        (["grid", "origin_m"], {"x": 1}, "a list"),
        (["nothing_moves"], "yes", "true or false, without quotes"),
    ],
)
def test_what_yaml_made_of_a_value_is_told_with_how_it_is_written(folder, plain, keys, value, expected):
    assert expected in refusal(folder.write(changed(plain, keys, value)))


def test_a_key_that_is_misspelt_is_told_before_the_one_that_is_missing_for_it(folder, plain):
    plain["grid"]["voxel_size_mm"] = plain["grid"].pop("voxel_size_m") * 1000
    assert "grid.voxel_size_mm: unknown key (did you mean voxel_size_m?)" in refusal(folder.write(plain))


def test_a_comma_for_a_decimal_dot_in_braces_is_told(folder, plain):
    text = folder.write(plain).read_text()
    text = text.replace("fx: 8.0", "noise: {constant_m: 0,3}\n  fx: 8.0")
    (folder.path / "site.yaml").write_text(text)
    assert "decimals have a dot: 0.3, not 0,3" in refusal(folder.path / "site.yaml")


def test_missing_and_endless_files(folder):
    assert "no such file; `elbowroom site new room.yaml`" in refusal(folder.path / "room.yaml")
    assert "is a folder; name the site file, such as" in refusal(folder.path)
    assert "at most 1,000,000 are read" in refusal(folder.write("# " + "x" * 1_000_000))
    (folder.path / "binary.yaml").write_bytes(b"\xff\xff\xfe")
    assert "not YAML in UTF-8" in refusal(folder.path / "binary.yaml")


def test_numbers_with_an_exponent_are_numbers(folder, plain):
    text = folder.write(plain).read_text().replace("voxel_size_m: 0.1", "voxel_size_m: 1e-1")
    assert Site.load(folder.write(text)).grid().voxel_size_m == 0.1


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (None, "p.txt: no such file; expected the pose, camera to world as 4 rows of 4 numbers"),
        ("1 0 0 0\n0 1 0 0\n0 0 1 0\n", "3x4 numbers, must be 4x4"),
        ("1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "contains NaN or infinity"),
        ("one 0 0 0\n", "not numbers"),
        ("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not rigid, off the nearest rotation by 1"),
        ("1 " * 60_000, "120,000 bytes"),
    ],
)
def test_unusable_pose_files(folder, plain, content, expected):
    if content is not None:
        (folder.path / "p.txt").write_text(content)
    plain["cameras"] = [{"name": "north", "pose_file": "p.txt"}]
    assert expected in refusal(folder.write(plain))


def test_a_grid_larger_than_memory():
    grid = VoxelGrid((0, 0, 0), (1000, 1000, 1000), 0.01)
    require_memory(grid, None)
    with pytest.raises(
        GridError, match=r"1000 x 1000 x 1000 voxels take 1\.5 GB, this computer has 1\.0 GB; choose"
    ):
        require_memory(grid, 1_000_000_000)


def test_a_sites_grid_is_held_against_this_computers_memory(folder, plain, monkeypatch):
    monkeypatch.setattr("elbowroom.site.schema.physical_memory_bytes", lambda: 1000)
    assert "this computer has 0.0 GB; choose larger voxels" in refusal(folder.write(plain))


def test_unknown_camera_is_answered_with_those_that_exist(folder, plain):
    site = Site.load(folder.write(plain))
    with pytest.raises(SiteError, match="unknown camera 'west'; cameras are north, south"):
        site.depth_scale_m("west")


@pytest.mark.parametrize(
    ("machine", "joints", "expected"),
    [
        ({"urdf": "none.urdf"}, {}, "machine: "),
        ({"without_body": ["tail"]}, {}, "link without body 'tail' does not exist"),
        ({"package_dirs": ["nowhere"]}, {}, "no folder"),
        ({"xacro_arguments": {"a": 1}}, {}, "nothing in the file is xacro"),
        ({"largest_link_m": 0.01}, {}, "at most 0.01 m may be"),
        ({"limit_tolerance_deg": -1}, {}, "limit_tolerance_deg: found -1, allowed: gr"),
        ({"unchecked_links": ["tail"]}, {}, "machine: machine arm: unchecked link 'tail' does not exist"),
        ({"world_from_base": np.diag([2.0, 1, 1, 1]).tolist()}, {}, "world_from_base: not rigid"),
        ({}, {"elbow": {"max_speed_deg_s": 1, "braking_time_s": 1}}, "joints.elbow: unknown joint; joints of arm are turn, slide"),
        ({}, {"turn": {"max_speed_m_s": 1, "braking_time_s": 1}}, "turn turns, its speed is written max_speed_deg_s"),
        ({}, {"slide": {"max_speed_deg_s": 1, "braking_time_s": 1}}, "slide slides, its speed is written max_speed_m_s"),
        ({}, {"slide": {"max_speed_m_s": 0, "braking_time_s": 1}}, "joints.slide.max_speed_m_s: found 0, allowed: gr"),
        ({}, {"slide": {"braking_time_s": 1}}, "exactly one of max_speed_m_s (prismatic) and max_speed_deg_s"),
        ({}, {"slide": {"max_speed_m_s": 1}}, "joints.slide.braking_time_s: missing"),
    ],
)  # fmt: skip
def test_machines_and_joints_that_do_not_fit(folder, plain, arm_urdf, machine, joints, expected):
    plain["machine"] = {"urdf": arm_urdf.name} | machine
    plain["joints"] = joints
    assert expected in refusal(folder.write(plain), lambda site: site.motions(site.machine()))


def test_keys_of_a_urdf_are_not_for_a_machine_of_the_package(folder, plain):
    plain["machine"] = {"builtin": "ceiling_c_arm", "package_dirs": ["a"]}
    assert "package_dirs only with urdf" in refusal(folder.write(plain))


def test_simulated_rooms_take_no_settings_that_the_simulator_makes(folder, plain):
    del plain["cameras"]
    plain["simulated"] = {}
    assert "camera_defaults of a simulated room: depth_kind, noise" in refusal(folder.write(plain))
    plain["camera_defaults"] = {}
    plain["simulated"] = {"resolution": "big"}
    assert "simulated.resolution: found 'big', allowed: " in refusal(folder.write(plain))


def places(content, before=()):
    """Keys that lead to each value of a site file."""
    inner = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    return [place for key, value in inner for place in ((*before, key), *places(value, (*before, key)))]


TEMPLATE = yaml.safe_load(NEW_SITE.read_text())
STRANGE = [
    None,
    0,
    -1,
    1e308,
    1e-300,
    NAN,
    float("inf"),
    10**30,
    "",
    "x",
    "a/b",
    "${",
    True,
    [],
    {},
    [[]],
    {"a": 1},
]


@settings(max_examples=60)
@given(place=st.sampled_from(places(TEMPLATE)), value=st.sampled_from(STRANGE))
def test_any_value_at_any_place_is_a_site_or_one_line(tmp_path_factory, place, value):
    path = tmp_path_factory.getbasetemp() / "strange.yaml"
    content = changed(copy.deepcopy(TEMPLATE), place, value)
    path.write_text(yaml.safe_dump(content))
    try:
        site = Site.load(path)
        assert len(site.cameras()) >= 1
        machine = site.machine()
        assert machine is None or bool(site.motions(machine)) == bool(site.entry.joints)
    except InputError as error:
        assert "\n" not in str(error) and str(error).startswith(str(path))
