"""The latch on disk: unlatched only after an end that was asked for; whatever happens to the file, latched."""

import errno
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.files import durable
from elbowroom.guard.fault import Fault
from elbowroom.guard.latch import Mark, latch_bytes, read_latch, write_latch
from elbowroom.guard.latch_file import LatchFile
from elbowroom.guard.reason import Reason

SITE = "cell 7 (2 motions, 12345678)"
MOVED = Fault(Reason.WATCH, "cam1", "camera cam1 has moved by 1.2°")
LATE = Fault(Reason.STALE, "", "too old")
SECOND = 1_000_000_000
WHOLE = {
    Mark.RUNNING: latch_bytes(SITE, Mark.RUNNING),
    Mark.LATCHED: latch_bytes(SITE, Mark.LATCHED, (MOVED, LATE)),
    Mark.ENDED: latch_bytes(SITE, Mark.ENDED),
}


def reads(tmp_path: Path, content: bytes) -> tuple[Fault, ...]:
    path = tmp_path / "latch"
    path.write_bytes(content)
    return read_latch(path, SITE).faults


def test_what_was_latched_is_read_again_word_for_word(tmp_path: Path) -> None:
    write_latch(tmp_path / "latch", SITE, Mark.LATCHED, (MOVED, LATE))
    faults = read_latch(tmp_path / "latch", SITE).faults
    assert faults == (MOVED, LATE)
    assert faults[0].sentence == "camera cam1 has moved by 1.2°"


def test_only_an_end_that_was_asked_for_is_unlatched(tmp_path: Path) -> None:
    assert reads(tmp_path, WHOLE[Mark.ENDED]) == ()
    assert [fault.reason for fault in reads(tmp_path, WHOLE[Mark.RUNNING])] == [Reason.UNCLEAN_END]


@pytest.mark.parametrize("mark", Mark)
def test_cut_at_any_byte_is_latched(tmp_path: Path, mark: Mark) -> None:
    for length in range(len(WHOLE[mark])):
        assert reads(tmp_path, WHOLE[mark][:length]), length


def test_any_byte_changed_is_latched(tmp_path: Path) -> None:
    content = WHOLE[Mark.ENDED]
    for place in range(len(content)):
        for bit in (0x01, 0x20, 0x80):
            changed = content[:place] + bytes([content[place] ^ bit]) + content[place + 1 :]
            assert reads(tmp_path, changed), (place, bit)


@given(st.binary(max_size=300))
def test_any_bytes_are_latched(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    assert reads(tmp_path_factory.getbasetemp(), content)


@pytest.mark.parametrize(
    "line",
    ["[" * 20_000, "null", "[]", "{}", '{"elbowroom latch": true}', '{"elbowroom latch": 1, "site": []}'],
)
def test_whole_lines_that_say_something_else_are_latched(tmp_path: Path, line: str) -> None:
    import hashlib

    digest = hashlib.sha256(line.encode()).hexdigest()
    assert reads(tmp_path, f"{line}\n{digest}\n".encode())


def test_no_latch_yet_is_latched(tmp_path: Path) -> None:
    kept = read_latch(tmp_path / "latch", SITE)
    assert kept.is_ours and "nobody has reset it" in kept.faults[0].sentence


def test_another_site_and_a_later_version_are_latched_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "latch"
    import hashlib

    later = latch_bytes(SITE, Mark.ENDED).split(b"\n")[0].replace(b'latch": 1', b'latch": 2')
    for content, words in (
        (latch_bytes("cell 8", Mark.ENDED), "is the latch of cell 8, not of cell 7"),
        (later + b"\n" + hashlib.sha256(later).hexdigest().encode() + b"\n", "is of version 2"),
    ):
        path.write_bytes(content)
        file = LatchFile(tmp_path, SITE)
        assert words in file.begin()[0].sentence
        for second in range(3):
            file.keep((), second * SECOND)
            assert file.fault is not None and words in file.fault.sentence
        file.end(())
        assert path.read_bytes() == content
        path.unlink()
        file.keep((), 10 * SECOND)
        assert file.fault is None
        assert read_latch(path, SITE).faults == (Fault(Reason.UNCLEAN_END),)


def test_a_folder_in_its_place_is_latched(tmp_path: Path) -> None:
    (tmp_path / "latch").mkdir()
    kept = read_latch(tmp_path / "latch", SITE)
    assert not kept.is_ours and "cannot be read" in kept.faults[0].sentence


def test_a_pipe_in_its_place_is_latched_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "latch")
    file = LatchFile(tmp_path, SITE)
    (fault,) = file.begin()
    assert fault.reason is Reason.LATCH_FILE and "no plain file; take it away" in fault.sentence
    file.keep((), 0)
    assert file.fault is not None and (tmp_path / "latch").is_fifo()


def test_a_pipe_where_a_write_begins_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / ".latch.unfinished")
    with pytest.raises(OSError):
        write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    assert not read_latch(tmp_path / "latch", SITE).faults


def test_mark_and_faults_go_together() -> None:
    for mark, faults in ((Mark.ENDED, (MOVED,)), (Mark.RUNNING, (MOVED,)), (Mark.LATCHED, ())):
        with pytest.raises(InputError, match=mark.value):
            latch_bytes(SITE, mark, faults)


# a run that goes on


def test_every_older_file_of_a_run_is_latched(tmp_path: Path) -> None:
    write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    file = LatchFile(tmp_path, SITE)
    assert file.begin() == ()
    versions = []
    for second, latched in enumerate([(), (MOVED,), (MOVED, LATE), (), (LATE,), ()]):
        file.keep(latched, second * SECOND)
        versions.append((tmp_path / "latch").read_bytes())
    assert len(set(versions)) == 4
    assert all(reads(tmp_path, version) for version in versions)
    file.end(())
    assert read_latch(tmp_path / "latch", SITE).faults == ()


@pytest.mark.parametrize("call", ["write", "fsync"])
def test_full_disk_is_a_fault_until_it_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    file = LatchFile(tmp_path, SITE)
    file.begin()
    file.keep((), 0)
    before = (tmp_path / "latch").read_bytes()

    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(durable.os, call, full)
        for second in range(1, 4):
            file.keep((MOVED,), second * SECOND)
            assert file.fault is not None and "No space left" in file.fault.sentence
        file.end(())
    assert (tmp_path / "latch").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["latch"]
    file.keep((MOVED,), 10 * SECOND)
    assert file.fault is None
    assert read_latch(tmp_path / "latch", SITE).faults == (MOVED,)


def test_a_write_that_comes_in_pieces_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = os.write
    monkeypatch.setattr(durable.os, "write", lambda file, data: write(file, bytes(data[:7])))
    write_latch(tmp_path / "latch", SITE, Mark.LATCHED, (MOVED,))
    assert read_latch(tmp_path / "latch", SITE).faults == (MOVED,)


def test_latch_is_on_the_disk_before_it_is_said_to_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    fsync = os.fsync

    def noted(file: int) -> None:
        calls.append(Path(f"/proc/self/fd/{file}").resolve().name)
        fsync(file)

    monkeypatch.setattr(durable.os, "fsync", noted)
    write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    assert calls == [".latch.unfinished", tmp_path.name]
    assert oct((tmp_path / "latch").stat().st_mode & 0o777) == "0o600"
