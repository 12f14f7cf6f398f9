"""Chained MCAP files: read by others, opened wherever they are cut off, and no bit changes unnoticed."""

import tracemalloc
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, SeekingReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from elbowroom.errors import BagError
from elbowroom.wire.chain import LENGTH, LINK
from elbowroom.wire.chained_file import HEAD, ChainedFile
from elbowroom.wire.ros_messages import text_of
from reference.chained_files import ATTACHED, messages_of, write_steps

STEPS = 6
SHARED = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> bytes:
    return write_steps(tmp_path_factory.mktemp("whole") / "whole.mcap", STEPS)


def opened(path: Path, content: bytes) -> ChainedFile:
    path.write_bytes(content)
    return ChainedFile(path)


def words(file: ChainedFile) -> list[str]:
    return [
        text_of(one.data) for number in range(len(file)) for one in file.step(number) if one.topic == "/words"
    ]


def test_a_whole_file_says_all_that_was_written(whole, tmp_path):
    with opened(tmp_path / "a.mcap", whole) as file:
        assert file.note is None and file.wrong() is None
        assert len(file) == STEPS and len(file.sum) == LENGTH
        for number in range(STEPS):
            due = [(told.topic, told.number, told.data) for told in messages_of(number)]
            assert [(one.topic, one.number, bytes(one.data)) for one in file.step(number)] == due
        assert file.attached("site.yaml") == ATTACHED[0].data
        assert file.attached("other") is None


@pytest.mark.parametrize("reader", [SeekingReader, NonSeekingReader])
def test_the_mcap_library_reads_it(whole, tmp_path, reader):
    (tmp_path / "a.mcap").write_bytes(whole)
    with (tmp_path / "a.mcap").open("rb") as stream:
        read = reader(stream, decoder_factories=[DecoderFactory()])
        found = [
            (channel.topic, message.sequence, told)
            for _, channel, message, told in read.iter_decoded_messages()
        ]
    assert len(found) == 2 * STEPS
    positions = [told.position[0] for topic, _, told in found if topic == "/joint_states"]
    assert positions == [number / 3 for number in range(STEPS)]
    assert [told.data for topic, _, told in found if topic == "/words"][1] == "step 1step 1"
    assert [number for topic, number, _ in found if topic == "/words"] == list(range(STEPS))


def test_the_mcap_library_finds_what_the_summary_says(whole, tmp_path):
    (tmp_path / "a.mcap").write_bytes(whole)
    with (tmp_path / "a.mcap").open("rb") as stream:
        read = SeekingReader(stream)
        summary = read.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 2 * STEPS
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count == STEPS
        assert summary.statistics.metadata_count == STEPS + 1
        assert [one.data for one in read.iter_attachments()] == [ATTACHED[0].data]
        assert len(list(read.iter_messages(topics=["/words"]))) == STEPS


def test_rosbags_reads_it(whole, tmp_path):
    (tmp_path / "a.mcap").write_bytes(whole)
    with AnyReader([tmp_path / "a.mcap"]) as reader:
        found = [reader.deserialize(raw, connection.msgtype) for connection, _, raw in reader.messages()]
    assert [one.position[0] for one in found if hasattr(one, "position")] == [n / 3 for n in range(STEPS)]


def test_a_file_cut_off_at_any_byte_opens_up_to_the_cut(whole, tmp_path):
    with opened(tmp_path / "a.mcap", whole) as file:
        due, ends = words(file), file.ends
    borders = {end + more for end in ends for more in (-1, 0, 1)}
    for length in sorted({*range(0, len(whole), 17), *range(40), *borders} - {len(whole)}):
        with opened(tmp_path / "a.mcap", whole[:length]) as file:
            found = words(file)
            assert found == due[: sum(end <= length for end in ends)]
            assert file.wrong() is None and file.note is not None, length
            assert "cut off" in file.note


def test_a_run_that_was_killed_leaves_a_file_without_its_end(tmp_path):
    write_steps(tmp_path / "a.mcap", STEPS, ends=False)
    with ChainedFile(tmp_path / "a.mcap") as file:
        assert len(words(file)) == STEPS
        assert file.note is not None and file.wrong() is None


def test_one_bit_that_is_another_is_noticed_in_any_byte(whole, tmp_path):
    for at in (*range(40), *range(40, len(whole), 13), *range(len(whole) - 40, len(whole))):
        changed = bytearray(whole)
        changed[at] ^= 1 << at % 8
        assert is_noticed(tmp_path / "a.mcap", bytes(changed)), at


def is_noticed(path: Path, content: bytes) -> bool:
    try:
        with opened(path, content) as file:
            return file.wrong() is not None or file.note is not None
    except BagError:
        return True


def test_steps_that_are_left_out_or_exchanged_are_noticed(whole, tmp_path):
    with opened(tmp_path / "a.mcap", whole) as file:
        ends = file.ends
    left_out = whole[: ends[1]] + whole[ends[2] :]
    exchanged = whole[: ends[1]] + whole[ends[2] : ends[3]] + whole[ends[1] : ends[2]] + whole[ends[3] :]
    for content in (left_out, exchanged, whole + b"\x00", whole + whole):
        assert is_noticed(tmp_path / "a.mcap", content)


@SHARED
@given(data=st.data())
def test_what_is_malformed_is_an_error_and_takes_little_memory(whole, tmp_path, data):
    content = bytearray(whole)
    for at in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=6)):
        content[at] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    more = data.draw(st.binary(max_size=64))
    content = content[:cut] + more + content[data.draw(st.integers(cut, len(content))) :]
    (tmp_path / "a.mcap").write_bytes(content)
    tracemalloc.start()
    try:
        with ChainedFile(tmp_path / "a.mcap") as file:
            words(file)
            file.attached("site.yaml")
            file.wrong()
    except (BagError, ValueError) as error:
        assert str(error)
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 2 * len(content) + 100_000


@SHARED
@given(st.binary(max_size=200))
def test_any_bytes_behind_the_head_are_read_or_refused(tmp_path, rest):
    with opened(tmp_path / "a.mcap", HEAD + rest) as file:
        assert len(file) == 0 and file.wrong() is None
        assert file.note is not None


@pytest.mark.parametrize(
    "content", [b"no MCAP at all, but some text", b"\x89MCAP1\r\n" + HEAD[8:], LINK + HEAD]
)
def test_another_file_is_refused(tmp_path, content):
    with pytest.raises(BagError, match=r"not a recording of `elbowroom monitor`"):
        opened(tmp_path / "a.mcap", content)


def test_a_file_that_is_not_there_is_refused_in_a_line(tmp_path):
    with pytest.raises(BagError, match="cannot be read"):
        ChainedFile(tmp_path / "none.mcap")


def test_a_file_is_never_written_over(tmp_path):
    write_steps(tmp_path / "a.mcap", 1)
    with pytest.raises(FileExistsError):
        write_steps(tmp_path / "a.mcap", 1)
