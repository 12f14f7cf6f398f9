"""Bags of other writers as recordings: the same frames, joints and free space as a folder of the same numbers."""

import numpy as np
import pytest
from mcap.writer import CompressionType

from elbowroom.errors import InputError
from elbowroom.site import Site
from elbowroom.sources import check_images, clocks_of, moments, open_room, time_findings, times_of
from reference import bag_files as bags
from reference.bag_room import bag_room

STORED = [(storage, packed) for storage in ("mcap", "sqlite3") for packed in (None, "message", "file")]


@pytest.fixture(scope="module")
def in_folder(tmp_path_factory):
    """The site of the folder, and its moments."""
    place, room = tmp_path_factory.mktemp("folder"), bag_room()
    room.write_folder(place / "images")
    site = Site.load(room.site(place / "site.yaml", {"layout": "folder", "folder": "images"}))
    return site, list(moments(site))


def site_of(tmp_path, bag, kind="16UC1", **more):
    room = bag_room()
    return Site.load(room.site(tmp_path / "site.yaml", room.recording(bag, kind) | more))


def same(one, other):
    assert len(one) == len(other) > 0
    for a, b in zip(one, other, strict=True):
        assert (a.now_ns, a.joints, a.joints_of) == (b.now_ns, b.joints, b.joints_of)
        assert [(f.camera, f.stamp_ns) for f in a.frames] == [(f.camera, f.stamp_ns) for f in b.frames]
        for mine, theirs in zip(a.frames, b.frames, strict=True):
            assert np.array_equal(mine.depth_m, theirs.depth_m)


@pytest.mark.parametrize(("storage", "compressed_as"), STORED)
def test_every_storage_says_what_the_folder_says(storage, compressed_as, in_folder, tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages(), storage, compressed_as)
    site = site_of(tmp_path, bag)
    same(list(moments(site)), in_folder[1])
    assert check_images(site) == (4, 16)
    assert time_findings(site) == time_findings(in_folder[0]) == ()
    assert times_of(site).lead.step_ns == times_of(in_folder[0]).lead.step_ns


@pytest.mark.parametrize("kind", ("big", "padded", "png"))
def test_every_form_of_whole_numbers_says_the_same(kind, in_folder, tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages(kind))
    same(list(moments(site_of(tmp_path, bag, kind))), in_folder[1])


def test_metres_say_the_same(in_folder, tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages("32FC1"))
    same(list(moments(site_of(tmp_path, bag, "32FC1"))), in_folder[1])


def test_quantised_metres_are_never_farther(in_folder, tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages("quantised"))
    found = list(moments(site_of(tmp_path, bag, "quantised")))
    for mine, theirs in zip(found, in_folder[1], strict=True):
        for a, b in zip(mine.frames, theirs.frames, strict=True):
            there = (b.depth_m > 0) & (b.depth_m < 10.0)
            assert ((a.depth_m > 0) == there).all()
            short = (b.depth_m - a.depth_m)[there]
            assert short.min() >= 0
            assert (short <= 1.01 * b.depth_m[there] ** 2 / 10100 + 1e-6).all()


@pytest.mark.parametrize("compression", CompressionType)
def test_a_file_alone_of_the_makers_of_the_format(compression, in_folder, tmp_path):
    bag = bags.written_mcap(tmp_path / "alone.mcap", bag_room().messages(), compression)
    same(list(moments(site_of(tmp_path, bag))), in_folder[1])


def test_a_file_without_chunks(in_folder, tmp_path):
    bag = bags.written_mcap(tmp_path / "plain.mcap", bag_room().messages(), use_chunking=False)
    same(list(moments(site_of(tmp_path, bag))), in_folder[1])


def test_free_space_and_verdicts_are_the_same_bits(in_folder, tmp_path):
    from elbowroom.motion import check_motions

    bag = bags.written(tmp_path / "bag", bag_room().messages("png"), "sqlite3", "message")
    found = []
    for site in (in_folder[0], site_of(tmp_path, bag, "png")):
        room = open_room(site)
        snapshot = room.snapshot(2)
        space = room.space_of(snapshot)
        machine, motions = room.machine_and_motions()
        found.append((space, check_motions(space, machine, snapshot.joints, motions)))
    (one, verdicts), (other, others) = found
    assert np.array_equal(one.free, other.free) and one.free.any()
    assert [(v.level, v.free_travel, v.cause) for v in verdicts] == [
        (v.level, v.free_travel, v.cause) for v in others
    ]


def test_joints_of_several_publishers_are_one_record(in_folder, tmp_path):
    room = bag_room()
    messages = [m for m in room.messages() if m[0] != "/joint_states"]
    for stamp, joints in room.joints.items():
        a = {name: joints[name] for name in ("larm", "long")}
        b = {name: joints[name] for name in ("carc", "propeller")}
        messages += [("/arm", stamp, bags.joint_state(a, stamp)), ("/arc", stamp, bags.joint_state(b, stamp))]
        messages.append(("/arc", stamp, bags.joint_state([], stamp, names=["larm"])))
    bag = bags.written(tmp_path / "bag", sorted(messages, key=lambda m: m[1]))
    same(list(moments(site_of(tmp_path, bag, joint_topics=["/arm", "/arc"]))), in_folder[1])


def test_stamps_that_are_zero_are_times_of_receipt_and_said(tmp_path):
    room = bag_room()
    messages = []
    for topic, at, message in room.messages():
        if "image_raw" in topic:
            message = bags.image(room.raw[topic.split("/")[1]][at - 12 * bags.MS], 0, "x")
        messages.append((topic, at, message))
    site = site_of(tmp_path, bags.written(tmp_path / "bag", messages))
    assert [moment.now_ns for moment in moments(site)] == [
        bags.T0 + 12 * bags.MS + n * 100 * bags.MS for n in range(4)
    ]
    told = [finding.text for finding in time_findings(site)]
    assert sum("headers have no stamp" in text for text in told) == 4


def test_images_without_a_stamp_among_others_are_left_out_and_said(tmp_path):
    room = bag_room()
    messages = room.messages()
    numbers = room.raw["cam00"][bags.T0]
    messages.append(("/cam00/depth/image_raw", bags.T0 + 950 * bags.MS, bags.image(numbers, 0)))
    again = bags.image(room.raw["cam01"][bags.T0], bags.T0, "cam01_optical")
    messages.append(("/cam01/depth/image_raw", bags.T0 + 950 * bags.MS, again))
    site = site_of(tmp_path, bags.written(tmp_path / "bag", messages))
    assert check_images(site) == (4, 16)  # and the one that came twice counts once
    assert [f.text for f in time_findings(site)] == [
        "/cam00/depth/image_raw: 1 messages without a stamp are left out"
    ]


def test_chunks_that_rosbags_compresses(in_folder, tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages(), "mcap", "storage")
    same(list(moments(site_of(tmp_path, bag))), in_folder[1])


def test_another_lens_than_the_bags_is_said(tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages())
    site = site_of(tmp_path, bag)
    other = site.entry.cameras[1].model_copy(update={"fx": site.entry.cameras[1].fx * 1.1})
    entry = site.entry.model_copy(update={"cameras": (site.entry.cameras[0], other, *site.entry.cameras[2:])})
    (said,) = time_findings(Site(site.path, entry))
    assert "camera cam01: the bag's CameraInfo says fx 24," in said.text and not said.stops


def test_clocks_are_told_by_site_check(tmp_path):
    messages = []
    for topic, at, message in bag_room().messages():
        if topic == "/cam02/depth/image_raw":
            message = bags.image(bag_room().raw["cam02"][at - 12 * bags.MS], at + 88 * bags.MS, "x")
        messages.append((topic, at, message))
    site = site_of(tmp_path, bags.written(tmp_path / "bag", messages), max_skew_ms=150)
    clocks = clocks_of(site)
    assert (clocks["cam02"].offset_ns, clocks["cam01"].offset_ns) == (-88 * bags.MS, 12 * bags.MS)
    texts = [finding.text for finding in time_findings(site)]
    assert any("camera cam02: its stamps are 88 ms ahead of when its images come" in text for text in texts)


def test_boards_are_looked_for_in_bags_too(in_folder, tmp_path):
    from elbowroom.calibrate.boards.capture import images_by_pose

    site = site_of(tmp_path, bags.written(tmp_path / "bag", bag_room().messages()))
    poses, others = images_by_pose(site), images_by_pose(in_folder[0])
    for images, theirs in zip(poses, others, strict=True):
        assert [(i.camera.name, i.stamp_ns, i.path.name) for i in images] == [
            (i.camera.name, i.stamp_ns, i.path.name) for i in theirs
        ]
        assert all(np.array_equal(a.raw(), b.raw()) for a, b in zip(images, theirs, strict=True))
        assert len({image.content() for image in images}) == 4


def test_a_site_of_a_bag_is_written_again_elsewhere(tmp_path):
    """Its file leads to the same bag; its topics are no paths, whatever a camera is called."""
    from elbowroom.site.written import moved

    recording = {"layout": "bag", "file": "bags/run", "topics": {"file": "/file/depth", "north": "/n"}}
    found = moved({"recording": recording}, tmp_path, tmp_path / "deep" / "er")
    assert (
        found["recording"]["file"] == "../../bags/run" and found["recording"]["topics"] == recording["topics"]
    )


def test_a_bag_from_before_the_machine_needs_no_joints(tmp_path):
    room = bag_room()
    messages = [message for message in room.messages() if message[0] != "/joint_states"]
    bags.written(tmp_path / "bag", messages)
    recording = {
        "layout": "bag",
        "file": "bag",
        "topics": {c.name: f"/{c.name}/depth/image_raw" for c in room.cameras},
    }
    room.site(tmp_path / "site.yaml", recording)
    with pytest.raises(InputError, match="joint"):
        next(moments(Site.load(tmp_path / "site.yaml")))
    room.site(tmp_path / "site.yaml", recording | {"without_machine": True})
    assert next(moments(Site.load(tmp_path / "site.yaml"))).joints is None
