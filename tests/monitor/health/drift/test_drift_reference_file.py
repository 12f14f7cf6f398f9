"""References come back as they were written; what is no reference is refused in one line."""

import io
import pickle
import zipfile

import numpy as np
import pytest

from elbowroom.errors import CalibrationError
from elbowroom.monitor import load_references, save_references
from elbowroom.monitor.health.drift import reference_file as files
from reference.watch_twins import CAMERAS, commissioned

REFERENCES = commissioned(CAMERAS)


@pytest.fixture
def path(tmp_path):
    save_references(REFERENCES, tmp_path / "room.watch.npz")
    return tmp_path / "room.watch.npz"


def rewritten(path, **changed):
    with np.load(path) as stored:
        arrays = {**{name: stored[name] for name in stored.files}, **changed}
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def test_references_come_back(path):
    for one, other in zip(REFERENCES, load_references(path), strict=True):
        assert (one.camera, one.width, one.height, one.radial) == (
            other.camera,
            other.width,
            other.height,
            other.radial,
        )
        assert one.lens == other.lens
        for name in files.SPOTS:
            assert (getattr(one, name) == getattr(other, name)).all()


def test_a_file_that_is_none_says_what_to_do(tmp_path):
    with pytest.raises(CalibrationError, match="commission"):
        load_references(tmp_path / "absent.npz")
    for content in (b"", b"not a zip", b"PK\x03\x04 half"):
        (tmp_path / "bad.npz").write_bytes(content)
        with pytest.raises(CalibrationError, match=r"bad\.npz: no reference") as caught:
            load_references(tmp_path / "bad.npz")
        assert "\n" not in str(caught.value)


def test_every_cut_of_a_file_is_refused(path):
    whole = path.read_bytes()
    for length in np.linspace(0, len(whole) - 1, 40).astype(int):
        path.write_bytes(whole[:length])
        with pytest.raises(CalibrationError):
            load_references(path)


@pytest.mark.parametrize(
    "changed",
    [
        {"version": np.array(2)},
        {"normal": None},
        {"names": np.array(["north", "east"])},
        {"counts": np.array([1, 2, 3])},
        {"counts": np.array([-1, 2, 3])},
        {"ray": np.zeros((5, 3))},
        {"pixel": np.zeros(3)},
        {"lenses": np.array(["a", "b", "c"])},
    ],
    ids=lambda changed: ",".join(changed),
)
def test_arrays_that_do_not_fit_are_refused(path, changed):
    with pytest.raises(CalibrationError, match=r"room\.watch\.npz: ") as caught:
        load_references(rewritten(path, **changed))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("depth_m", np.nan), ("depth_m", -1.0), ("normal", 0.0), ("pixel", 10**9), ("sigma_m", -1.0)],
)
def test_numbers_that_cannot_be_are_refused(path, name, value):
    with np.load(path) as stored:
        array = stored[name].copy()
    array[3] = value
    with pytest.raises(CalibrationError, match="camera north"):
        load_references(rewritten(path, **{name: array}))


def test_nothing_is_unpickled(path):
    class Trap:
        def __reduce__(self):
            return pytest.fail, ("it was unpickled",)

    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(buffer, {"descr": "|O", "fortran_order": False, "shape": (1,)})
    buffer.write(pickle.dumps([Trap()]))
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["names.npy"] = buffer.getvalue()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(CalibrationError, match="no reference"):
        load_references(path)


def test_a_member_that_would_fill_the_memory_is_refused_before_it_is_read(path):
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        members = archive.namelist()
    with zipfile.ZipFile(path) as archive:
        kept = {name: archive.read(name) for name in members if name != "depth_m.npy"}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in kept.items():
            archive.writestr(name, content)
        archive.writestr("depth_m.npy", b"\0" * (files.MAX_BYTES + 1))
    with pytest.raises(CalibrationError, match="depth_m of"):
        load_references(path)
