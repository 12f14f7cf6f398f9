"""`elbowroom site from-bag`: what a bag says of its cameras, lenses and places, and what it does not."""

import json

import numpy as np
import pytest

from elbowroom.cli import run as run_command
from elbowroom.errors import BagError, InputError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.site import Site
from elbowroom.sources import moments
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.depth_topics import camera_name
from elbowroom.sources.bags.frames import frames_of
from elbowroom.sources.bags.lenses import lens_of
from elbowroom.sources.bags.messages import CameraInfo, Header, camera_info_of
from elbowroom.sources.bags.site_of import Wish, site_of
from reference import bag_files as bags
from reference.bag_room import bag_room


@pytest.fixture
def run(capsys):
    def of(*words):
        code = run_command(words)
        told = capsys.readouterr()
        return code, told.out + told.err

    return of


def said(path, messages, **wish):
    with Bag(bags.written(path, messages)) as bag:
        return site_of(bag, Wish(**wish))


def refusal(path, messages, **wish):
    with pytest.raises(InputError) as caught:
        said(path, messages, **wish)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_the_command_writes_a_site_that_plays(tmp_path, run):
    room = bag_room()
    bags.written(tmp_path / "run", room.messages())
    out = tmp_path / "room.yaml"
    code, told = run(
        "site", "from-bag", str(tmp_path / "run"), "--out", str(out), "--json", str(tmp_path / "row.json")
    )
    assert code == 0 and "4 cameras in world" in told and "carc, larm, long, propeller" in told
    site = Site.load(out)
    for camera, true in zip(site.cameras(), room.cameras, strict=True):
        assert camera.name == true.name and (camera.width, camera.height) == (true.width, true.height)
        assert camera.world_from_camera == pytest.approx(true.world_from_camera, abs=1e-9)
        assert camera.intrinsics == true.intrinsics
    found = list(moments(site))
    assert [len(moment.frames) for moment in found] == [4] * 4
    low, high = site.grid().lower_m, site.grid().upper_m
    assert (low < [-1.5, -1.5, 0.3]).all() and (high > [1.5, 1.5, 2.1]).all()
    assert (high - low < 7).all()
    text = out.read_text()
    assert text.count("not in the bag") >= 5 and site.cameras()[0].noise is not None
    code, told = run("site", "from-bag", str(tmp_path / "run"), "--out", str(out))
    assert code == 2 and "is there already" in told and out.read_text() == text
    assert json.loads((tmp_path / "row.json").read_text())["rows"][0]["world"] == "world"
    code, told = run("site", "topics", str(tmp_path / "run"))
    assert (
        code == 0
        and "camera cam02: 16UC1, 48x36, 4 images, 10.0 images a second, axes of cam02_optical" in told
    )


def test_a_chain_of_frames_leads_to_the_world(tmp_path):
    """The camera's own driver says optical in link, a second node link in the ceiling, a third the ceiling in map."""
    room, chance = bag_room(), np.random.default_rng(1)
    messages = [m for m in room.messages() if m[0] != "/tf_static"]
    poses = {}
    for camera in room.cameras:
        world_from_map, map_from_ceiling, ceiling_from_link = (_pose(chance) for _ in range(3))
        if not poses:
            poses["map"] = world_from_map
            messages.append(
                ("/tf_static", 1, bags.transforms(bags.transform("world", "map", world_from_map)))
            )
        parts = [
            bags.transform("map", f"/{camera.name}_ceiling", map_from_ceiling),
            bags.transform(f"{camera.name}_ceiling", f"{camera.name}_link", ceiling_from_link),
        ]
        optical = (
            np.linalg.inv(poses["map"] @ map_from_ceiling @ ceiling_from_link) @ camera.world_from_camera
        )
        own = bags.transforms(bags.transform(f"{camera.name}_link", f"{camera.name}_optical", optical))
        messages += [("/tf_static", 2, bags.transforms(*parts)), (f"/{camera.name}/tf_static", 3, own)]
    base = bags.transforms(bags.transform("map", "robot_base", np.eye(4)))
    messages.append(("/tf_static", 4, base))
    found = said(tmp_path / "bag", sorted(messages, key=lambda m: m[1]))
    assert found.world == "world"
    for camera, true in zip(found.cameras, room.cameras, strict=True):
        assert camera.world_from_camera == pytest.approx(true.world_from_camera, abs=1e-9)
    by_map = said(tmp_path / "again", sorted(messages, key=lambda m: m[1]), world="map")
    assert set(found.bases) == {"robot_base"} and found.bases["robot_base"] == pytest.approx(poses["map"])
    assert poses["map"] @ by_map.cameras[2].world_from_camera == pytest.approx(
        room.cameras[2].world_from_camera, abs=1e-9
    )
    by_camera = said(tmp_path / "third", sorted(messages, key=lambda m: m[1]), world="cam00_optical")
    assert by_camera.cameras[0].world_from_camera == pytest.approx(np.eye(4), abs=1e-9)


def _pose(chance):
    from scipy.spatial.transform import Rotation

    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = (
        Rotation.random(random_state=int(chance.integers(1e6))).as_matrix(),
        chance.normal(size=3),
    )
    return pose


def test_places_that_are_not_said_or_move(tmp_path):
    messages = [m for m in bag_room().messages() if m[0] != "/tf_static"]
    assert "there are none (topic /tf_static)" in refusal(tmp_path / "none", messages)
    poses = {f"{c.name}_optical": c.world_from_camera for c in bag_room().cameras}
    links = {name: bags.transform("world", name, pose) for name, pose in poses.items()}
    three = bags.transforms(*list(links.values())[:3])
    text = refusal(tmp_path / "three", [*messages, ("/tf_static", 1, three)])
    assert "no chain of static transforms leads from cam00_optical to cam03_optical" in text
    text = refusal(tmp_path / "lost", [*messages, ("/tf_static", 1, three)], world="world")
    assert "from cam03_optical to world: cam03_optical is in none; frames are cam00_optical" in text
    still = [("/tf", n, bags.transforms(links["cam03_optical"])) for n in range(3)]
    found = said(tmp_path / "still", [*messages, ("/tf_static", 1, three), *still])
    assert any("said by /tf, not /tf_static" in note for note in found.notes)
    moved = bags.transform(
        "world", "cam03_optical", poses["cam03_optical"] + np.eye(4)[:, [3, 3, 3, 0]].T * 0
    )
    moved.transform.translation.x += 0.01
    text = refusal(
        tmp_path / "moves", [*messages, ("/tf_static", 1, three), *still, ("/tf", 9, bags.transforms(moved))]
    )
    assert "cam03_optical moves in world, and cameras must stand still" in text
    circle = bags.transforms(bags.transform("cam00_optical", "world", np.eye(4)))
    text = refusal(tmp_path / "circle", [*messages, ("/tf_static", 1, three), ("/tf_static", 2, circle)])
    assert "frames in a circle" in text
    long = bags.transform("world", "cam03_optical", np.eye(4))
    long.transform.rotation.w = 1.5
    assert "quaternion of cam03_optical has length 1.5" in refusal(
        tmp_path / "long", [*messages, ("/tf_static", 1, bags.transforms(long))]
    )
    with Bag(bags.written(tmp_path / "twice", [
        ("/tf_static", 1, three), ("/tf_static", 2, bags.transforms(moved)), ("/tf_static", 3, bags.transforms(links["cam03_optical"])),  # noqa: E501
    ])) as bag:  # fmt: skip
        assert frames_of(bag).notes == (
            "tf: cam03_optical is said to be at two places by /tf_static; the last is taken",
        )


def test_two_cameras_in_one_frame_are_refused(tmp_path):
    """Images brought to the pixels of others, or a driver started twice: all would stand at one place."""
    from dataclasses import replace

    messages = [
        (
            topic,
            at,
            replace(message, header=replace(message.header, frame_id="optical"))
            if "image" in topic
            else message,
        )
        for topic, at, message in bag_room().messages()
    ]
    assert "say the same frame, optical: each camera has one of its own" in refusal(
        tmp_path / "bag", messages
    )


def test_topics_of_one_camera_are_chosen_between(tmp_path):
    room, extra = bag_room(), []
    camera, frame = room.cameras[0], "cam00_optical"
    for stamp, numbers in room.raw["cam00"].items():
        extra += [
            ("/cam00/aligned_depth_to_color/image_raw", stamp, bags.image(numbers, stamp, frame)),
            ("/cam00/aligned_depth_to_color/camera_info", stamp, bags.camera_info(camera, stamp, frame)),
            ("/cam00/color/image_raw", stamp, bags.image(numbers, stamp, frame, encoding="rgb8")),
            (
                "/cam00/depth/image_raw/compressedDepth",
                stamp,
                bags.compressed(bags.png(numbers), stamp, frame),
            ),
        ]
    messages = sorted([*room.messages(), *extra], key=lambda m: m[1])
    text = refusal(tmp_path / "bag", messages)
    assert "camera cam00 has 2 topics of depth: /cam00/aligned_depth_to_color/image_raw (16UC1" in text
    assert "aligned to colour" in text and "--depth cam00=" in text and "compressedDepth" not in text
    with Bag(tmp_path / "bag") as bag:
        given = ["/cam00/depth/image_raw", "west=/cam01/depth/image_raw"]
        found = site_of(bag, Wish(depth=given))
        assert {name: topic.name for name, topic in found.topics.items()} == {
            "cam00": "/cam00/depth/image_raw", "west": "/cam01/depth/image_raw",
        }  # fmt: skip
        for wrong, why in {
            "/gone": "has no depth images on '/gone'",
            "/cam00/color/image_raw": "'rgb8' is no depth",
        }.items():
            with pytest.raises(InputError, match=why):
                site_of(bag, Wish(depth=[wrong]))
        with pytest.raises(InputError, match="two topics of camera cam00"):
            site_of(bag, Wish(depth=["/cam00/depth/image_raw", "/cam00/aligned_depth_to_color/image_raw"]))


def test_a_bag_without_depth_or_camera_info(tmp_path):
    messages = bag_room().messages()
    without = [m for m in messages if m[0] != "/cam03/depth/camera_info"]
    text = refusal(tmp_path / "info", without)
    assert (
        "no CameraInfo of /cam03/depth/image_raw: expected /cam03/depth/camera_info; there are /cam00" in text
    )
    assert "no topic of depth images; topics are /joint_states" in refusal(
        tmp_path / "depth", [m for m in messages if m[0] in ("/joint_states", "/tf_static")]
    )
    nowhere = [
        (t, at, bags.image(bag_room().raw["cam00"][bags.T0], at) if "image" in t else m)
        for t, at, m in messages
    ]
    assert "its header names no frame" in refusal(tmp_path / "frame", nowhere)


def lens(size=(48, 36), rectified=False, **fields):
    camera = DepthCamera(
        name="c", width=fields.pop("w", 48), height=fields.pop("h", 36), world_from_camera=np.eye(4),
        intrinsics=Intrinsics(fx=30, fy=31, cx=23.5, cy=17.5),
    )  # fmt: skip
    sent = bags.camera_info(camera, 0, **fields)
    return lens_of(
        camera_info_of(bytes(bags.STORE.serialize_cdr(sent, bags.INFO)), "/i"), size, rectified, "/i"
    )


def test_lenses_in_opencvs_models():
    assert lens().intrinsics == Intrinsics(fx=30, fy=31, cx=23.5, cy=17.5)
    d = [0.1, -0.2, 0.01, 0.02, 0.3, 0.4, 0.5, 0.6]
    assert lens(d=np.array(d[:5])).intrinsics.distortion == tuple(d[:5])
    assert lens(d=np.array(d[:4])).intrinsics.distortion == (*d[:4], 0)
    assert lens(d=np.array(d), distortion_model="rational_polynomial").intrinsics.distortion == tuple(d)
    padded = np.pad(np.array(d), (0, 6))
    assert lens(d=padded, distortion_model="rational_polynomial").intrinsics.distortion == tuple(d)
    assert lens(d=np.zeros(0), distortion_model="").intrinsics.distortion == ()
    rectified = lens(
        rectified=True, d=np.array(d[:5]), p=np.array([40, 0, 20, 0, 0, 41, 15, 0, 0, 0, 1.0, 0])
    )
    assert (
        rectified.intrinsics == Intrinsics(fx=40, fy=41, cx=20, cy=15) and "rectified" in rectified.notes[0]
    )


def test_a_region_that_is_binned_sees_what_the_sensor_sees():
    """A pixel of the small image lies in the middle of the four that it is made of."""
    small = lens((20, 10), roi=bags.region(4, 6, 40, 20), binning_x=2, binning_y=2).intrinsics
    for u, v in ((0, 0), (19, 9), (7, 3)):
        whole_u, whole_v = 4 + 2 * u + 0.5, 6 + 2 * v + 0.5
        assert (u - small.cx) / small.fx == pytest.approx((whole_u - 23.5) / 30)
        assert (v - small.cy) / small.fy == pytest.approx((whole_v - 17.5) / 31)


@pytest.mark.parametrize(
    ("told", "fields"),
    {
        "distortion model 'equidistant' is not read": {"distortion_model": "equidistant", "d": np.zeros(4)},
        "distortion model 'thin_prism' is not read": {"distortion_model": "thin_prism"},
        "8 coefficients of distortion model 'plumb_bob', 5": {"d": np.ones(8)},
        "is of images of 36 x 48": {"w": 36, "h": 48},
        "is of images of 24 x 18, after region and binning, and the image has 48 x 36": {"binning_x": 2, "binning_y": 2},  # noqa: E501
        "is this camera calibrated": {"k": np.zeros(9)},
        "D is [nan": {"d": np.full(5, np.nan)},
        "camera matrix: expected": {"k": np.array([30, 1, 20, 0, 30, 20, 0, 0, 1.0])},
    }.items(),
)  # fmt: skip
def test_lenses_that_are_not_read(told, fields):
    with pytest.raises(BagError) as caught:
        lens(**fields)
    assert told in str(caught.value) and str(caught.value).startswith("/i: ")


@pytest.mark.parametrize(
    ("topic", "camera"),
    {
        "/north/depth/image_rect_raw": "north",
        "/camera/north/depth/image_rect_raw/compressedDepth": "camera_north",
        "/north/north/aligned_depth_to_color/image_raw": "north",
        "/cell/kinect1/depth_registered/image_raw": "cell_kinect1",
        "/cam03/image": "cam03",
        "/depth/image_raw": "depth",
        "/cam1_depth": "cam1_depth",
        "/oak/stereo/image_raw": "oak",
    }.items(),
)
def test_cameras_are_named_by_their_topics(topic, camera):
    assert camera_name(topic) == camera


def test_monitor_plays_a_bag_and_tells_of_its_clocks(tmp_path, run):
    room = bag_room()
    bag = bags.written(tmp_path / "run", room.messages(), "sqlite3")
    site = room.site(tmp_path / "room.yaml", room.recording(bag), max_frame_age_ms=500)
    code, told = run("monitor", str(site), "--json", str(tmp_path / "out.json"))
    assert code == 0 and "playing" in told
    rows = json.loads((tmp_path / "out.json").read_text())["rows"]
    cycles = [row for row in rows if row["kind"] == "cycle"]
    assert cycles and all(row["fault"] is None and row["skew_ms"] == 0 for row in cycles)
    # 12 ms on the way, and what the clock may be off
    assert all(row["oldest_age_ms"] > 16 for row in cycles)
    clocks = {row["camera"]: row for row in rows if row["kind"] == "clock"}
    assert set(clocks) == {camera.name for camera in room.cameras}
    assert all(row["offset_ms"] == 12 and 4 < row["bound_ms"] < 5 for row in clocks.values())


def test_what_rectifying_turned_or_moved_is_said():
    turn = np.array([[np.cos(0.05), 0, np.sin(0.05)], [0, 1, 0], [-np.sin(0.05), 0, np.cos(0.05)]])
    p = np.hstack([np.array([[80.0, 0, 79.5], [0, 80, 59.5], [0, 0, 1]]), [[-4.0], [0], [0]]])
    for r, beside, rectified, words in (
        (turn, p, True, ("a turn of 2.9 degrees", "50 mm to the right")),
        (np.zeros((3, 3)), p * [1, 1, 1, 0], True, ()),
        (turn, p, False, ()),
    ):
        info = CameraInfo(
            Header(0, "c"), 120, 160, "plumb_bob", np.zeros(5), p[:, :3], r, beside, (0, 0), (0, 0, 0, 0)
        )
        notes = lens_of(info, (160, 120), rectified, "/depth").notes
        assert len(notes) == len(words) and all(word in note for word, note in zip(words, notes, strict=True))


def test_a_folder_with_a_bag_of_ros_1_is_told_how_to_convert_it(tmp_path):
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(BagError, match=r"old\.bag is a bag of ROS 1: rosbags-convert --src"):
        Bag(tmp_path)


def test_camera_info_of_two_cameras_on_one_topic_is_refused(tmp_path):
    room, topic = bag_room(), "/cam00/depth/camera_info"
    mixed = [*room.messages(), (topic, bags.T0, bags.camera_info(room.cameras[1], bags.T0, "cam01_optical"))]
    text = refusal(tmp_path / "frames", mixed)
    assert "CameraInfo of two frames, cam01_optical and cam00_optical" in text
    lens = bags.camera_info(room.cameras[0], bags.T0, "cam00_optical")
    lens.k[0] *= 1.2
    text = refusal(tmp_path / "lens", [*room.messages(), (topic, bags.T0 + 150 * bags.MS, lens)])
    assert "the lens or the size of message 3 is not that of the beginning" in text


def test_a_rectified_image_whose_p_is_not_filled_in_has_the_lens_of_k_if_that_changes_nothing():
    k, straight = np.array([[60.5, 0, 49.5], [0, 60.5, 37], [0, 0, 1]]), np.eye(3)

    def lens(d=0.0, r=straight, k=k):
        info = CameraInfo(
            Header(0, "c"), 75, 100, "plumb_bob", np.full(5, d), k, r, np.zeros((3, 4)), (0, 0), (0, 0, 0, 0)
        )
        return lens_of(info, (100, 75), True, "/depth")

    for r in (straight, np.zeros((3, 3))):
        found = lens(r=r)
        assert (found.intrinsics.fx, found.intrinsics.cx) == (60.5, 49.5)
        assert "P is all zeros: K is taken" in found.notes[0]
    for wrong in ({"d": 0.1}, {"r": np.diag([1.0, -1.0, -1.0])}, {"k": np.zeros((3, 3))}):
        with pytest.raises(BagError, match="is this camera calibrated"):
            lens(**wrong)
