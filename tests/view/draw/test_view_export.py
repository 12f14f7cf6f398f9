"""Files hold what the space holds, and are whole or not there."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.view import save_npz, save_ply, save_sections
from elbowroom.view.draw.palette import COLOURS, Label

GRID = VoxelGrid(origin_m=(-0.5, 0.0, 1.0), shape=(6, 5, 4), voxel_size_m=0.2)


@pytest.fixture
def space() -> FreeSpace:
    """Half of the voxels free, some surface, some blind, at random."""
    rng = np.random.default_rng(7)
    free = rng.random(GRID.shape) < 0.5
    surface = ~free & (rng.random(GRID.shape) < 0.4)
    blind = ~free & (rng.random(GRID.shape) < 0.3)
    planes = [bits.pack(plane, GRID) for plane in (free, surface, blind, surface | blind)]
    return FreeSpace(GRID, *planes)


def test_npz_gives_back_grid_and_planes(tmp_path, space):
    with np.load(save_npz(tmp_path / "room.npz", space), allow_pickle=False) as file:
        assert tuple(file["origin_m"]) == GRID.origin_m
        assert tuple(file["shape"]) == GRID.shape
        assert file["voxel_size_m"] == GRID.voxel_size_m
        for name in ("free", "surface", "unseen"):
            assert file[name].dtype == np.bool_
            np.testing.assert_array_equal(file[name], getattr(space, name))
        np.testing.assert_array_equal(file["blind"], bits.unpack(space.blind_words, GRID))


def test_ply_is_read_by_others_with_place_and_colour(tmp_path, space):
    cloud = trimesh.load(save_ply(tmp_path / "room.ply", space, unseen=False))
    wanted = GRID.centre_of(np.argwhere(space.surface))
    assert len(wanted) > 10
    np.testing.assert_allclose(np.asarray(cloud.vertices), wanted, atol=1e-6)
    assert {tuple(colour[:3]) for colour in np.asarray(cloud.colors)} == {COLOURS[Label.SURFACE]}


def test_ply_holds_the_border_of_unseen_space_and_not_its_inside(tmp_path):
    unseen = np.zeros(GRID.shape, dtype=bool)
    unseen[:3] = True
    space = FreeSpace(GRID, bits.pack(~unseen, GRID), bits.empty(GRID), bits.empty(GRID), bits.empty(GRID))
    cloud = trimesh.load(save_ply(tmp_path / "room.ply", space))
    assert len(cloud.vertices) == 5 * 4
    np.testing.assert_allclose(np.asarray(cloud.vertices)[:, 0], GRID.centre_of((2, 0, 0))[0], atol=1e-6)


@pytest.mark.parametrize(("save", "name"), [(save_npz, "room.zip"), (save_ply, "room.npz")])
def test_another_ending_is_refused(tmp_path, space, save, name):
    with pytest.raises(InputError, match="must be a file name that ends in"):
        save(tmp_path / name, space)


@pytest.mark.parametrize(("save", "name"), [(save_npz, "room.npz"), (save_ply, "room.ply")])
def test_a_missing_folder_is_named(tmp_path, space, save, name):
    with pytest.raises(InputError, match=r"nowhere.*name a folder that exists"):
        save(tmp_path / "nowhere" / name, space)


@pytest.mark.parametrize("interruption", [OSError, KeyboardInterrupt])
def test_an_interrupted_write_leaves_no_file(tmp_path, interruption):
    with pytest.raises(interruption), whole_file(tmp_path / "half.txt") as unfinished:
        unfinished.write_text("the first half")
        raise interruption
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_write_keeps_the_file_that_was_there(tmp_path, space, monkeypatch):
    path = save_npz(tmp_path / "room.npz", space)
    before = path.read_bytes()

    def fails_half_way(file, **planes):
        file.write(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(np, "savez_compressed", fails_half_way)
    with pytest.raises(OSError, match="disk full"):
        save_npz(path, space)
    assert [path] == list(tmp_path.iterdir())
    assert path.read_bytes() == before


def test_a_file_in_the_place_of_the_folder_is_named(tmp_path, space):
    (tmp_path / "out").write_text("")
    with pytest.raises(InputError, match="is no folder"):
        save_sections(space, tmp_path / "out")
    assert folder(tmp_path / "a" / "b").is_dir()


def test_a_folder_in_the_place_of_the_file_is_named_before_the_work(tmp_path):
    with pytest.raises(InputError, match="is a folder; name a file"), whole_file(tmp_path):
        pytest.fail("the block must not begin")
