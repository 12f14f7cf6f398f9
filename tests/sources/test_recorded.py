# ruff: noqa: E501  (tables of one case a line)
import numpy as np
import pytest
from PIL import Image

from elbowroom.errors import InputError
from elbowroom.sensing import JointRecord
from elbowroom.site import Site
from elbowroom.site.notes import notes_of
from elbowroom.sources import check_images, excluded_frames, moments, silent_cameras

MS = 1_000_000


def refusal(site, **more):
    with pytest.raises(InputError) as caught:
        list(moments(site, **more))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.fixture
def stamped(folder, plain):
    """Layout `folder`: north every 10 ms, south every 20 ms and 1 ms late."""
    for number in range(4):
        folder.image(f"rec/north/{number * 10 * MS}.png", raw=1000 + number)
    for number in range(2):
        folder.image(f"rec/south/{(number * 20 + 1) * MS}.png", raw=2000 + number)
    plain["recording"] = {"layout": "folder", "folder": "rec", "max_skew_ms": 2}
    return plain


def test_frames_near_in_time_make_a_moment(folder, stamped):
    site = Site.load(folder.write(stamped))
    found = list(moments(site))
    assert [moment.now_ns for moment in found] == [1 * MS, 10 * MS, 21 * MS, 30 * MS]
    assert [[frame.camera for frame in moment.frames] for moment in found] == [
        ["north", "south"], ["north"], ["north", "south"], ["north"],
    ]  # fmt: skip
    assert [frame.stamp_ns for frame in found[2].frames] == [20 * MS, 21 * MS]
    assert found[2].frames[0].depth_m[0, 0] == pytest.approx(1.002)
    assert found[0].joints is None
    assert check_images(site) == (4, 6)


def test_a_moment_is_as_late_as_its_latest_frame(folder, stamped):
    for moment in moments(Site.load(folder.write(stamped))):
        assert moment.now_ns == max(frame.stamp_ns for frame in moment.frames)


def test_a_camera_without_a_folder_gave_nothing(folder, stamped):
    stamped["cameras"].append({"name": "west", "position_m": [0, 1, 1], "look_at_m": [0, 0, 0]})
    site = Site.load(folder.write(stamped))
    found = list(moments(site))
    assert silent_cameras(site) == ("west",)
    assert all("west" not in [frame.camera for frame in moment.frames] for moment in found)


def test_age_limits_hold_only_where_there_are_times(folder, stamped):
    site = Site.load(folder.write(stamped))
    assert site.max_age_ns is None and "frames of any age count" in " ".join(notes_of(site))
    stamped["max_frame_age_ms"] = 50
    assert Site.load(folder.write(stamped)).max_age_ns == 50 * MS
    stamped["recording"] = {"layout": "stampless", "folder": "rec"}
    site = Site.load(folder.write(stamped))
    assert site.max_age_ns is None
    assert "frames have no times: no limit on their age" in notes_of(site)
    assert "max_frame_age_ms has no effect on frames without times" in notes_of(site)


def test_joints_are_those_of_each_frames_time(folder, stamped, arm_urdf):
    (folder.path / "rec" / "joints.csv").write_text(f"stamp_ns,turn,slide\n0,0,0\n{40 * MS},0.4,0.8\n")
    stamped["machine"] = {"urdf": arm_urdf.name}
    third = list(moments(Site.load(folder.write(stamped))))[2]
    assert third.joints_of["north"] == pytest.approx({"turn": 0.2, "slide": 0.4})
    assert third.joints_of["south"] == pytest.approx({"turn": 0.21, "slide": 0.42})
    assert third.joints == third.joints_of["south"]


def test_a_machine_needs_its_joints(folder, stamped, arm_urdf):
    stamped["machine"] = {"urdf": arm_urdf.name}
    site = Site.load(folder.write(stamped))
    assert "joints.csv: no such file" in refusal(site)
    joints = {"turn": 0.1, "slide": 0.0}
    assert next(moments(site, joints)).joints == joints
    (folder.path / "rec" / "joints.csv").write_text("stamp_ns,turn,slide\n0,0,0\n1000000,0,0\n")
    assert "joints at 10000000 ns: not known" in refusal(site)
    stamped["recording"]["max_joint_gap_ms"] = 1
    (folder.path / "rec" / "joints.csv").write_text(f"stamp_ns,turn,slide\n0,0,0\n{40 * MS},0,0\n")
    assert "gap of 40 ms" in refusal(Site.load(folder.write(stamped)))
    stamped["recording"] = {"layout": "stampless", "folder": "rec", "files": {"south": "north/*.png"}}
    site = Site.load(folder.write(stamped))
    assert "records none of its machine; give positions" in refusal(site)
    record = JointRecord(np.array([0]), {"turn": np.zeros(1), "slide": np.zeros(1)})
    assert "has no time, so a joint record" in refusal(site, joints=record)
    assert len(list(moments(site, joints))) == 4


def test_stampless_images_meet_in_order_of_names(folder, plain):
    for number in (2, 1, 10):
        folder.image(f"rec/north/n{number:02d}.png", raw=number)
    folder.image("rec/b.png", raw=1)
    folder.image("rec/a.png", raw=2)
    folder.image("rec/c.png", raw=10)
    plain["recording"] = {
        "layout": "stampless",
        "folder": "rec",
        "files": {"south": ["b.png", "a.png", "c.png"]},
    }
    site = Site.load(folder.write(plain))
    found = list(moments(site))
    assert [[round(frame.depth_m[0, 0] * 1000) for frame in moment.frames] for moment in found] == [
        [1, 1], [2, 2], [10, 10],
    ]  # fmt: skip
    assert all(moment.now_ns is None for moment in found)
    assert check_images(site) == (3, 6)


def test_depth_scale_is_the_cameras_and_65535_is_no_return(folder, plain):
    folder.image("rec/north/a.png", raw=5000)
    folder.image("rec/south/a.png", raw=65535)
    plain["cameras"][0]["depth_scale_m"] = 1e-4
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    (moment,) = moments(Site.load(folder.write(plain)))
    assert moment.frames[0].depth_m[0, 0] == pytest.approx(0.5)
    assert (moment.frames[1].depth_m == 0).all()


@pytest.mark.parametrize(
    ("recording", "expected"),
    [
        ({"folder": "none"}, "recording.folder: no folder "),
        ({"folder": "${ELBOWROOM_NO_SUCH:-none}"}, "set ELBOWROOM_NO_SUCH to where it lies"),
        ({"folder": "${ELBOWROOM_NO_SUCH}/x"}, "${ELBOWROOM_NO_SUCH} is not set"),
        ({"files": {"west": "*.png"}}, "recording.files: unknown camera 'west'; cameras are north, south"),
        ({"files": {"south": "*.tif"}}, "recording.files.south: no file *.tif in "),
        ({"files": {"south": "../*.png"}}, "'../*.png' does not stay inside"),
        ({"files": {"south": "/etc/*.png"}}, "'/etc/*.png' does not stay inside"),
        ({"files": {"south": ["a.png", "a.png"]}}, "recording.files.south: a.png is there twice; one frame per camera"),
        ({"files": {"south": ["gone.png"]}}, "gone.png: no such file"),
        ({"files": {"south": ["a.png", "north/a.png"]}}, "frames per camera are north 1, south 2; without times they"),
    ],
)  # fmt: skip
def test_stampless_folders_that_cannot_be_read(folder, plain, recording, expected):
    folder.image("rec/north/a.png")
    folder.image("rec/a.png")
    plain["recording"] = {"layout": "stampless", "folder": "rec"} | recording
    assert expected in refusal(Site.load(folder.write(plain)))


def test_two_frames_of_one_camera_at_one_time_are_refused(folder, stamped):
    folder.image(f"rec/north/0{10 * MS}.png")
    assert f"two frames of camera north at {10 * MS} ns" in refusal(Site.load(folder.write(stamped)))


@pytest.mark.parametrize("ends", [(".pgm", ".pgm"), (".pgm", ".png")])
def test_images_may_be_pgm_and_both_kinds_may_lie_together(folder, stamped, ends):
    as_png = [f.depth_m for each in moments(Site.load(folder.write(stamped))) for f in each.frames]
    for path, end in zip(sorted((folder.path / "rec").glob("*/*.png")), ends * 3, strict=True):
        with Image.open(path) as image:
            raw = np.asarray(image)
        path.unlink()
        Image.fromarray(raw.astype(np.uint16)).save(path.with_suffix(end))
    again = [f.depth_m for each in moments(Site.load(folder.write(stamped))) for f in each.frames]
    np.testing.assert_array_equal(again, as_png)
    folder.image(f"rec/north/{10 * MS}.png" if ends[1] == ".pgm" else "rec/colour/1.pgm")
    text = refusal(Site.load(folder.write(stamped)))
    assert "two frames of camera north" in text or "colour: images of an unknown camera" in text


def test_names_that_are_no_times_are_refused(folder, stamped):
    folder.image("rec/north/first.png")
    text = refusal(Site.load(folder.write(stamped)))
    assert "first.png: name must be the time of exposure in whole nanoseconds" in text


def test_images_of_an_unknown_camera_are_refused_unless_named(folder, stamped):
    folder.image("rec/colour/1.png")
    assert "colour: images of an unknown camera; cameras are north, south" in refusal(
        Site.load(folder.write(stamped))
    )
    stamped["recording"]["ignore"] = ["colour"]
    assert len(list(moments(Site.load(folder.write(stamped))))) == 4


def test_an_empty_recording_is_refused(folder, plain):
    (folder.path / "rec").mkdir()
    plain["recording"] = {"layout": "folder", "folder": "rec"}
    assert "no frames; expected" in refusal(Site.load(folder.write(plain)))
    del plain["recording"]
    assert "recording: missing; this command reads one" in refusal(Site.load(folder.write(plain)))


def test_an_image_of_another_size_is_found_without_reading_it(folder, stamped):
    folder.image(f"rec/north/{10 * MS}.png", size=(9, 6))
    site = Site.load(folder.write(stamped))
    with pytest.raises(InputError, match="9 x 6 pixels, its camera has 8 x 6"):
        check_images(site)
    assert "9 x 6 pixels, its camera has 8 x 6" in refusal(site)


@pytest.fixture
def scenes(folder, plain):
    """Layout `seven_scenes`: three frames, the second with a pose a little off."""
    for number in (0, 25, 50):
        folder.image(f"rec/frame-{number:06d}.depth.png", raw=1000 + number)
        scale = 1.0005 if number == 25 else 1
        (folder.path / "rec" / f"frame-{number:06d}.pose.txt").write_text(
            f"{scale} 0 0 {number}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
        )
    (folder.path / "rec" / "camera-intrinsics.txt").write_text("8 0 3.5\n0 8 2.5\n0 0 1\n")
    return {
        "grid": plain["grid"],
        "camera_defaults": {"width": 8, "height": 6, "min_depth_m": 0.4},
        "recording": {"layout": "seven_scenes", "folder": "rec"},
    }


def test_each_frame_of_seven_scenes_is_a_camera_of_its_own_at_one_moment(folder, scenes):
    site = Site.load(folder.write(scenes))
    (moment,) = moments(site)
    assert [camera.name for camera in site.cameras()] == ["frame-000000", "frame-000025", "frame-000050"]
    assert [frame.camera for frame in moment.frames] == [camera.name for camera in site.cameras()]
    assert [camera.centre_in_world[0] for camera in site.cameras()] == [0, 25, 50]
    assert site.cameras()[0].intrinsics.cx == 3.5 and site.cameras()[0].min_depth_m == 0.4
    assert moment.now_ns is None and moment.frames[1].depth_m[0, 0] == pytest.approx(1.025)
    assert any("frame-000025" in note and "brought to the nearest" in note for note in notes_of(site))
    assert excluded_frames(site) == ()


def test_frames_left_out_can_be_asked_for(folder, scenes):
    scenes["recording"] |= {"exclude": [25]}
    site = Site.load(folder.write(scenes))
    assert [camera.name for camera in site.cameras()] == ["frame-000000", "frame-000050"]
    ((camera, frame),) = excluded_frames(site)
    assert camera.name == frame.camera == "frame-000025"
    assert "frames left out: 25" in notes_of(site)


@pytest.mark.parametrize(
    ("recording", "expected"),
    [
        ({"include": [0, 30]}, "frame 30 is not there; it has 3 from 0 to 50"),
        ({"exclude": [75]}, "frame 75 is not there"),
        ({"include": [0], "exclude": [0, 25]}, "each frame in include or in exclude; [0] in both"),
        ({"exclude": [0, 25, 50]}, "all 3 frames are excluded"),
    ],
)
def test_frames_that_are_not_there_are_refused(folder, scenes, recording, expected):
    scenes["recording"] |= recording
    with pytest.raises(InputError) as caught:
        Site.load(folder.write(scenes)).cameras()
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("frame-000025.pose.txt", None, "frame 25: "),
        ("frame-000025.pose.txt", "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "contains NaN"),
        ("frame-000025.pose.txt", "1.1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not rigid, off the nearest rotation by 0.1"),
        ("camera-intrinsics.txt", None, "camera-intrinsics.txt: no such file"),
        ("camera-intrinsics.txt", "0 0 1\n0 0 1\n0 0 1\n", "fx is 0.0, must be a finite number of pixels above 0"),
        ("camera-intrinsics.txt", "8 1 1\n0 8 1\n0 0 1\n", "camera matrix: expected [[fx, 0, cx]"),
    ],
)  # fmt: skip
def test_poses_and_matrices_that_are_none_are_refused(folder, scenes, name, text, expected):
    path = folder.path / "rec" / name
    if text is None:
        path.unlink()
    else:
        path.write_text(text)
    site_path = folder.write(scenes)
    with pytest.raises(InputError) as caught:
        Site.load(site_path).cameras()
    assert expected in str(caught.value) and str(caught.value).startswith(str(site_path))


def test_a_folder_without_frames_is_refused(folder, scenes):
    (folder.path / "empty").mkdir()
    scenes["recording"]["folder"] = "empty"
    with pytest.raises(InputError, match="no frames; expected frame-000000"):
        Site.load(folder.write(scenes)).cameras()
