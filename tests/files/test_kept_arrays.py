"""Arrays kept on disk: the same as those made, never out of date, and nobody's loss if the folder is gone."""

import os

import numpy as np
import pytest

from elbowroom.files import kept_arrays as module
from elbowroom.files.kept_arrays import cache_folder, kept_arrays
from elbowroom.machine.samples import BodySamples, body_samples
from reference import motion_machines as machines

LARGE = {"a": np.arange(30_000, dtype=np.int64), "b": np.ones((3, 5), dtype=np.float32)}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("ELBOWROOM_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


def counting(arrays):
    made = []

    def make():
        made.append(1)
        return arrays

    return make, made


def same(one, other):
    assert one.keys() == other.keys()
    for name in one:
        assert one[name].dtype == other[name].dtype
        np.testing.assert_array_equal(one[name], other[name])


def test_arrays_are_made_once_and_read_as_they_were(folder):
    make, made = counting(LARGE)
    for _ in range(3):
        same(kept_arrays("large", make), LARGE)
    assert len(made) == 1 and [file.name for file in folder.iterdir()] == ["large.npz"]


def test_small_arrays_are_not_kept(folder):
    make, made = counting({"a": np.arange(5)})
    for _ in range(2):
        kept_arrays("small", make)
    assert len(made) == 2 and not folder.exists()


@pytest.mark.parametrize("harm", ["cut", "flipped", "other", "empty"])
def test_a_file_that_is_not_whole_is_made_anew(folder, harm):
    make, made = counting(LARGE)
    kept_arrays("large", make)
    path = folder / "large.npz"
    content = bytearray(path.read_bytes())
    if harm == "flipped":
        content[len(content) // 2] ^= 1
    path.write_bytes({"cut": content[:1000], "other": b"no arrays", "empty": b""}.get(harm, content))
    for _ in range(2):
        same(kept_arrays("large", make), LARGE)
    assert len(made) == 2


def test_where_nothing_can_be_written_arrays_are_made_each_time(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    for value in ("", str(tmp_path / "file" / "kept")):
        monkeypatch.setenv("ELBOWROOM_CACHE", value)
        make, made = counting(LARGE)
        for _ in range(2):
            same(kept_arrays("large", make), LARGE)
        assert len(made) == 2


def test_the_folder_is_the_users_unless_told_otherwise(monkeypatch, tmp_path):
    monkeypatch.delenv("ELBOWROOM_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "elbowroom"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "elbowroom"


def test_what_was_written_first_goes_first(folder, monkeypatch):
    monkeypatch.setattr(module, "FOLDER_BYTES", 600_000)
    for number in range(4):
        kept_arrays(f"large{number}", lambda: LARGE)
        for age, file in enumerate(sorted(folder.iterdir(), reverse=True)):
            os.utime(file, (10**9 - age, 10**9 - age))
    assert sorted(file.name for file in folder.iterdir()) == ["large2.npz", "large3.npz"]


def test_samples_of_a_machine_are_the_same_made_or_read_and_each_size_has_its_own(folder, tmp_path):
    first, again = (machines.slider_and_arm(tmp_path) for _ in range(2))
    made = [body_samples(first, size) for size in (0.02, 0.021)]
    assert len(list(folder.iterdir())) == 2
    for samples in made:
        read = body_samples(again, samples.voxel_size_m)
        assert read is not samples
        for name in BodySamples.__slots__:
            if name != "__weakref__":
                np.testing.assert_array_equal(getattr(read, name), getattr(samples, name))
        assert not read.points.flags.writeable
    assert len(list(folder.iterdir())) == 2
