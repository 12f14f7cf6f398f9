"""What is wrong with a bag is said by name, in a line; nothing crashes, hangs or takes memory that a number asks."""

import contextlib
import functools
import random
import struct
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType

from elbowroom.errors import BagError, FrameError, InputError
from elbowroom.site import Site
from elbowroom.sources import moments, time_findings
from elbowroom.sources.bags import depth, messages
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.site_of import Wish, site_of
from reference import bag_files as bags
from reference.bag_room import bag_room

CUTS = 150
BOUND = 30_000_000
"""The bags of these tests are of 200 kB; reading them takes no more than this [bytes]."""


def refusal(bag, kind="16UC1", tmp_path=None, **more):
    room = bag_room()
    site = room.site((tmp_path or bag.parent) / "site.yaml", room.recording(bag, kind) | more)
    with pytest.raises(InputError) as caught:
        list(moments(Site.load(site)))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def with_image(tmp_path, change, topic="/cam02/depth/image_raw"):
    """A bag in which the images of a camera are other messages."""
    found = [(t, at, change(m) if t == topic else m) for t, at, m in bag_room().messages()]
    return bags.written(tmp_path / "bag", found)


def replaced(message, **fields):
    for name, value in fields.items():
        object.__setattr__(message, name, value)
    return message


IMAGES = {
    "encoding 'rgb8' is no depth": {"encoding": "rgb8"},
    "encoding '64FC1' is no depth": {"encoding": "64FC1"},
    "36 x 48 pixels, its camera has 48 x 36; width and height look exchanged": {
        "width": 36,
        "height": 48,
        "step": 72,
    },
    "rows of 90 bytes, 48 pixels take 96": {"step": 90},
    "3,456 bytes of pixels, 36 rows of 200 are 7,200": {"step": 200},
    "an image of 48 x 4,294,967,295 pixels": {"height": 2**32 - 1},
    "an image of 0 x 36 pixels": {"width": 0},
}


@pytest.mark.parametrize("told", IMAGES)
def test_images_that_are_none(told, tmp_path):
    bag = with_image(tmp_path, lambda message: replaced(message, **IMAGES[told]))
    text = refusal(bag)
    assert told in text and "/cam02/depth/image_raw" in text


COMPRESSED = {
    "format 'jpeg' is no depth": ("jpeg", b"x" * 99),
    "format '16UC1; png compressed' is no depth": ("16UC1; png compressed", b"x" * 99),
    "encoding 'bgr8' is no depth": ("bgr8; compressedDepth png", b"x" * 99),
    "compressedDepth as 'zfp'": ("16UC1; compressedDepth zfp", b"x" * 99),
    "5 bytes of compressedDepth": ("16UC1; compressedDepth", b""),
    "not a PNG file": ("16UC1; compressedDepth", struct.pack(">16xII", 48, 36) + b"x" * 99),
    "quantised by A = 0": ("32FC1; compressedDepth", b"x" * 99),
    "truncated RVL": ("16UC1; compressedDepth rvl", struct.pack("<II", 48, 36) + bytes([16]) * 32),
    "an image of 4,000,000,000 x 36 pixels": (
        "16UC1; compressedDepth rvl",
        struct.pack("<II", 4 * 10**9, 36) + bytes(32),
    ),
}


@pytest.mark.parametrize("told", COMPRESSED)
def test_compressed_images_that_are_none(told, tmp_path):
    form, data = COMPRESSED[told]
    found = []
    for topic, at, message in bag_room().messages("png"):
        if topic == "/cam02/depth/image_raw/compressedDepth":
            message = bags.compressed(data, at - 12 * bags.MS, "", form)
            if told.startswith("5 bytes"):
                message = replaced(message, data=message.data[:5])
        found.append((topic, at, message))
    text = refusal(bags.written(tmp_path / "bag", found), "png")
    assert told in text and "/cam02/depth" in text


def twins(count):
    """The bag, in which the first images of a camera come again with other pixels and the same stamps."""
    other = np.full((36, 48), 7, np.uint16)
    stamps = list(bag_room().raw["cam00"])[:count]
    again = [("/cam00/depth/image_raw", at + 10**9, bags.image(other, at, "cam00_optical")) for at in stamps]
    return [*bag_room().messages(), *again]


def test_of_two_images_at_one_time_the_first_is_kept_and_said(tmp_path):
    bag = bags.written(tmp_path / "bag", twins(1))
    room = bag_room()
    site = Site.load(room.site(tmp_path / "site.yaml", room.recording(bag)))
    plain = Site.load(
        room.site(tmp_path / "one.yaml", room.recording(bags.written(tmp_path / "one", room.messages())))
    )
    for mine, theirs in zip(moments(site), moments(plain), strict=True):
        assert mine.now_ns == theirs.now_ns
        assert all(
            np.array_equal(a.depth_m, b.depth_m) for a, b in zip(mine.frames, theirs.frames, strict=True)
        )
    (said,) = time_findings(site)
    assert f"1 of 5 images of camera cam00 have the time of another, the first {bags.T0} ns" in said.text
    assert "came first is kept" in said.text and not said.stops


def test_many_images_at_one_time_are_refused_with_what_to_do(tmp_path):
    text = refusal(bags.written(tmp_path / "bag", twins(3)))
    assert "3 of 7 images of camera cam00" in text and "stamp each image by its exposure" in text


@pytest.mark.parametrize(("storage", "packed"), [("mcap", None), ("mcap", "message"), ("sqlite3", None)])
@pytest.mark.parametrize("name", ["cam01_optical", "/a_frame_of_a_camera" * 9])
def test_images_of_two_cameras_on_one_topic_are_refused(storage, packed, name, tmp_path):
    pixels = bag_room().raw["cam01"][bags.T0]
    at = bags.T0 + 150 * bags.MS
    other = ("/cam00/depth/image_raw", at, bags.image(pixels, at, name))
    bag = bags.written(tmp_path / "bag", [*bag_room().messages(), other], storage, packed)
    text = refusal(bag)
    assert "cam00" in text and f"images of two frames, cam00_optical and {name.removeprefix('/')}" in text
    assert "on one topic, /cam00/depth/image_raw" in text
    with Bag(bag) as opened, pytest.raises(FrameError, match="images of two frames"):
        site_of(opened, Wish())


def test_a_frame_with_a_slash_or_none_is_no_other_camera(tmp_path):
    pixels, found = bag_room().raw["cam00"][bags.T0], bag_room().messages()
    for number, name in enumerate(("/cam00_optical", "")):
        at = bags.T0 + (150 + number) * bags.MS
        found.append(("/cam00/depth/image_raw", at, bags.image(pixels, at, name)))
    room, bag = bag_room(), bags.written(tmp_path / "bag", found)
    assert list(moments(Site.load(room.site(tmp_path / "site.yaml", room.recording(bag)))))


def test_no_bag_at_all(tmp_path):
    bag = bags.written(tmp_path / "bag", bag_room().messages())
    (tmp_path / "empty").mkdir()
    assert "no bag: neither metadata.yaml nor files" in refusal(tmp_path / "empty")
    assert "no folder or file" in refusal(tmp_path / "gone")
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(99))
    assert "rosbags-convert --src old.bag --dst old" in refusal(tmp_path / "old.bag")
    (tmp_path / "text.mcap").write_text("hello")
    assert "neither MCAP nor a database" in refusal(tmp_path / "text.mcap")
    assert "describes a bag; name the folder" in refusal(bag / "metadata.yaml")


def test_topics_that_are_not_what_the_site_says(tmp_path):
    room = bag_room()
    bag = bags.written(tmp_path / "bag", room.messages())
    topics = room.recording(bag)["topics"]
    assert "no topic /gone; topics are /cam00/depth/camera_info" in refusal(
        bag, topics={**topics, "cam01": "/gone"}
    )
    assert "must be sensor_msgs/msg/Image or" in refusal(bag, topics={**topics, "cam01": "/joint_states"})
    assert "recording.topics: none for camera cam03" in refusal(
        bag, topics={"cam00": "/a", "cam01": "/b", "cam02": "/c"}
    )
    assert "unknown camera 'north'" in refusal(bag, topics={**topics, "north": "/n"})
    twice = room.site(tmp_path / "twice.yaml", room.recording(bag) | {"topics": dict.fromkeys(topics, "/a")})
    with pytest.raises(InputError, match="more than once"):
        Site.load(twice)
    assert "no topic /joints" in refusal(bag, joint_topics=["/joints"])
    assert "must be sensor_msgs/msg/JointState" in refusal(bag, joint_topics=["/tf_static"])


def joints_changed(tmp_path, change):
    found = []
    for topic, at, message in bag_room().messages():
        for one in change(message, at) if topic == "/joint_states" else [message]:
            found.append((topic, at, one))
    return bags.written(tmp_path / "bag", found)


JOINTS = {
    "no joint larm (is it l_arm?) in /joint_states; joints there are carc, l_arm": lambda m, at: [
        replaced(m, name=[n.replace("larm", "l_arm") for n in sorted(m.name)])
    ],
    "4 names of joints and 2 positions": lambda m, at: [replaced(m, position=m.position[:2])],
    "no joint long in /joint_states; joints there are none with a position": lambda m, at: [
        replaced(m, position=m.position[:0])
    ],
    "joint long is at": lambda m, at: [m, bags.joint_state([9.0], at - bags.MS, names=["long"])],
    "never meet": lambda m, at: [replaced(m, header=bags.header(at - 3600 * 10**9))],
    "look like degrees": lambda m, at: [
        replaced(m, position=m.position + (60 * np.array([n == "larm" for n in m.name])))
    ],
}


@pytest.mark.parametrize("told", JOINTS)
def test_joints_that_are_none(told, tmp_path):
    assert told in refusal(joints_changed(tmp_path, JOINTS[told]))


def test_positions_that_are_no_numbers_are_not_known(tmp_path):
    def change(message, at):
        wrong = bags.T0 + 100 * bags.MS < at < bags.T0 + 300 * bags.MS
        return [replaced(message, position=message.position * np.nan)] if wrong else [message]

    bag = joints_changed(tmp_path, change)
    assert "not known, the record has a gap" in refusal(bag, max_joint_gap_ms=100)


def file_of(tmp_path, how):
    if how == "sqlite3":
        return next(bags.written(tmp_path / "bag", bag_room().messages(), "sqlite3").glob("*.db3"))
    return bags.written_mcap(tmp_path / "bag.mcap", bag_room().messages(), CompressionType[how], 20_000)


@pytest.mark.parametrize("how", ("NONE", "LZ4", "ZSTD"))
def test_a_file_that_was_cut_off_anywhere_opens_up_to_there(how, tmp_path):
    whole, room = file_of(tmp_path, how), bag_room()
    data = whole.read_bytes()
    with Bag(whole) as bag:
        topics = {name: [m.stamp_ns for m in bag.messages(name)] for name in bag.topics}
    cut = tmp_path / "cut.mcap"
    before = 0
    for size in sorted(random.Random(1).sample(range(8, len(data)), CUTS)):
        cut.write_bytes(data[:size])
        with Bag(cut) as bag:
            found = {name: [m.stamp_ns for m in bag.messages(name)] for name in bag.topics}
            for name, stamps in found.items():
                assert stamps == topics[name][: len(stamps)]
                for message in bag.messages(name):
                    assert len(bag.read(message)) == message.size
            many = sum(map(len, found.values()))
            assert many >= before
            before = many
            assert bag.notes or many == sum(map(len, topics.values()))
    assert before > 0
    cut.write_bytes(data[: len(data) // 2])
    site = Site.load(room.site(tmp_path / "cut.yaml", room.recording(cut)))
    snapshot = next(moments(site))
    assert len(snapshot.frames) == 4
    (said,) = [f.text for f in time_findings(site) if "cut off or damaged" in f.text]
    with Bag(cut) as bag:
        count = sum(map(bag.count, bag.topics))
    assert f"; {count:,} messages are read, 0." in said and "s from the first to the last" in said


def test_a_database_that_was_cut_off_is_read_or_refused_by_name(tmp_path):
    data = file_of(tmp_path, "sqlite3").read_bytes()
    cut, read = tmp_path / "cut.db3", 0
    for size in sorted(random.Random(2).sample(range(16, len(data)), CUTS)):
        cut.write_bytes(data[:size])
        try:
            with Bag(cut) as bag:
                for name in bag.topics:
                    for message in bag.messages(name):
                        read += len(bag.read(message)) > 0
        except BagError as error:
            assert str(error).startswith(str(cut)) and "\n" not in str(error)


def row_of_4_gib(data, page_size, page, cell):
    """A row of a table says that it is 2**32 - 1 bytes long, and its header longer than a page."""
    changed, at = bytearray(data), page * page_size
    start = at + struct.unpack_from(">H", data, at + (100 if page == 0 else 0) + 8 + 2 * cell)[0]
    said = b"\x8f\xff\xff\xff\x7f" + b"\x01" + b"\xa7\x08"
    changed[start : start + len(said)] = said
    return bytes(changed)


def test_a_row_that_says_that_it_is_4_gib_long_is_damage_and_no_lack_of_memory(tmp_path):
    # SQLite answers "no memory" to some of them, without asking for any
    whole = file_of(tmp_path, "sqlite3")
    data, bad = whole.read_bytes(), tmp_path / "bad.db3"
    (page_size,) = struct.unpack_from(">H", data, 16)
    leaves = [
        (at // page_size, *struct.unpack_from(">H", data, head + 3))
        for at in range(0, len(data), page_size)
        if data[head := at + (100 if at == 0 else 0)] == 13
    ]
    with Bag(whole) as bag:
        messages = sum(map(bag.count, bag.topics))
    said = []
    for page, cells in leaves:
        for cell in range(cells):
            bad.write_bytes(row_of_4_gib(data, page_size, page, cell))
            try:
                with Bag(bad) as bag:
                    assert sum(map(bag.count, bag.topics)) <= messages
                    said += bag.notes
            except BagError as error:
                assert "sqlite3 FILE .recover" in str(error)
                said.append(str(error))
    assert any("no memory for the length that a row says" in one for one in said)


@pytest.mark.parametrize("how", ("NONE", "LZ4", "ZSTD", "sqlite3"))
def test_damage_anywhere_is_no_crash_and_takes_no_memory(how, tmp_path):
    data, chance, bad = file_of(tmp_path, how).read_bytes(), random.Random(3), tmp_path / "bad.bag"
    tracemalloc.start()
    try:
        for _ in range(60):
            changed = bytearray(data)
            for _ in range(chance.choice((1, 4, 40))):
                at = chance.randrange(16, len(data))
                changed[at : at + 8] = chance.choice((b"\xff" * 8, bytes(8), chance.randbytes(8)))
            bad.write_bytes(changed)
            tracemalloc.reset_peak()
            try:
                with Bag(bad) as bag:
                    for name, topic in bag.topics.items():
                        for message in bag.messages(name):
                            _read_as(topic.type, bag.read(message))
            except InputError as error:
                assert str(error).startswith(str(bad))
            assert tracemalloc.get_traced_memory()[1] < BOUND
    finally:
        tracemalloc.stop()


READERS = {
    bags.IMAGE: lambda data: depth.depth_of(bags.IMAGE, data, "m", (48, 36)),
    bags.COMPRESSED: lambda data: depth.depth_of(bags.COMPRESSED, data, "m", (48, 36)),
    bags.INFO: lambda data: messages.camera_info_of(data, "m"),
    bags.JOINTS: lambda data: messages.joint_state_of(data, "m"),
    bags.TF: lambda data: messages.transforms_of(data, "m"),
}


def _read_as(kind, data):
    if kind in READERS:
        with contextlib.suppress(BagError, FrameError):
            READERS[kind](data)


@functools.cache
def _sent():
    room = bag_room()
    kinds = {}
    for _, _, message in [*room.messages(), *room.messages("png"), *room.messages("quantised")]:
        kinds.setdefault((message.__msgtype__, getattr(message, "format", "")), message)
    return [(kind, bytes(bags.STORE.serialize_cdr(message, kind))) for (kind, _), message in kinds.items()]


@settings(max_examples=150)
@given(st.data())
def test_malformed_messages_are_refused_by_name(data):
    kind, sent = data.draw(st.sampled_from(_sent()))
    changed = bytearray(sent)
    for _ in range(data.draw(st.integers(0, 3))):
        at = data.draw(st.integers(0, min(len(sent), 400) - 1))
        changed[at : at + 4] = data.draw(st.binary(min_size=1, max_size=4))
    _read_as(kind, bytes(changed[: data.draw(st.integers(0, len(changed)))]))


def test_a_chunk_that_says_it_is_huge_is_left_out(tmp_path):
    zeros = bags.written_mcap(
        tmp_path / "z.mcap", [("/t", 1, ("std_msgs/msg/String", bytes(40_000_000)))], CompressionType.ZSTD
    )
    data = bytearray(zeros.read_bytes())
    # after the magic and the header record: kind and length of the chunk, its first and last time, what it unpacks to
    at = 8 + 9 + struct.unpack_from("<Q", data, 9)[0] + 9 + 16
    assert 40_000_000 < struct.unpack_from("<Q", data, at)[0] < 40_001_000
    data[at : at + 8] = struct.pack("<Q", 1000)
    zeros.write_bytes(data)
    tracemalloc.start()
    try:
        with Bag(zeros) as bag:
            assert "unpacks to more than the 1,000 bytes" in bag.notes[0]
        data[at : at + 8] = struct.pack("<Q", 2**50)
        zeros.write_bytes(data)
        with Bag(zeros) as bag:
            assert "at most" in bag.notes[0] and "its messages are left out" in bag.notes[0]
        assert tracemalloc.get_traced_memory()[1] < BOUND
    finally:
        tracemalloc.stop()


def test_missing_packages_and_files_are_said(tmp_path, monkeypatch):
    import sys

    from elbowroom.errors import PackageError

    bag = bags.written(tmp_path / "bag", bag_room().messages(), "mcap", "message")
    monkeypatch.setitem(sys.modules, "zstandard", None)
    with pytest.raises(PackageError, match=r"zstandard.*pip install"):
        Bag(bag).stamp_ns(Bag(bag).messages("/joint_states")[0])
    monkeypatch.undo()
    (bag / "metadata.yaml").unlink()
    with Bag(bag) as opened:
        assert "metadata.yaml is missing" in opened.notes[0] and len(opened.topics) == 10
    (bag / "metadata.yaml").write_text(
        "rosbag2_bagfile_information: {relative_file_paths: [../../etc/passwd]}"
    )
    with pytest.raises(InputError, match="does not stay inside"):
        Bag(bag)
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information: {relative_file_paths: [a.mcap]}")
    with pytest.raises(BagError, match=r"named in metadata\.yaml, and not there"):
        Bag(bag)


@pytest.mark.parametrize("storage", ("mcap", "sqlite3"))
def test_a_file_that_was_compressed_and_cut_off(storage, tmp_path):
    # zstd gives what it has block by block, of 128 kB
    noise = [
        ("/noise", bags.T0 + n * 20 * bags.MS, ("std_msgs/msg/String", random.Random(n).randbytes(60_000)))
        for n in range(15)
    ]
    found = sorted([*bag_room().messages(), *noise], key=lambda message: message[1])
    (whole,) = bags.written(tmp_path / "bag", found, storage, "file").glob("*.zstd")
    data, cut = whole.read_bytes(), tmp_path / f"cut.{storage}.zstd"
    found.clear()
    for size in sorted(random.Random(4).sample(range(4, len(data)), 20)):
        cut.write_bytes(data[:size])
        try:
            with Bag(cut) as bag:
                found.append(sum(map(bag.count, bag.topics)))
                assert bag.notes
        except BagError as error:
            assert "\n" not in str(error)
    assert storage == "sqlite3" or (found == sorted(found) and found[-1] > 0)
