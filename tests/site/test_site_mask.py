"""Masks in site files, and the command that finds them."""

import json

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli.site import site_app
from elbowroom.errors import SiteError
from elbowroom.files.mask_file import read_mask, write_mask
from elbowroom.site import Site
from elbowroom.site.notes import notes_of


def command(*words):
    site_app(args=[str(word) for word in words], standalone_mode=False)


@pytest.fixture
def recorded(folder, plain):
    """A site whose cameras never return in the left three columns."""
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    for camera in ("north", "south"):
        for number in range(12):
            folder.image(f"rec/{camera}/{number}.png")
    depth = np.full((6, 8), 2000, dtype=np.uint16)
    depth[:, :3] = 0
    for path in (folder.path / "rec").rglob("*.png"):
        Image.fromarray(depth).save(path)
    return folder.write(plain)


def test_masks_are_found_and_used(recorded, folder, plain, tmp_path, capsys):
    command("mask", recorded, "--out", tmp_path / "masks", "--json", tmp_path / "rows.json")
    said = capsys.readouterr().out
    assert "37.5 % of its pixels never returned in 12 images; 37.5 % masked in 1 regions" in said
    assert "few images" not in said
    rows = json.loads((tmp_path / "rows.json").read_text())["rows"]
    assert [row["camera"] for row in rows] == ["north", "south"]
    np.testing.assert_array_equal(
        np.flatnonzero(read_mask(tmp_path / "masks/north.png", 8, 6).all(axis=0)), range(3)
    )
    assert (tmp_path / "masks/north_picture.png").exists()
    plain["cameras"][0]["mask"] = str(tmp_path / "masks/north.png")
    site = Site.load(folder.write(plain))
    north, south = site.cameras()
    assert north.mask is not None and north.mask.mean() == pytest.approx(0.375) and south.mask is None
    assert any("declared to say nothing" in note and "north 37.5 %" in note for note in notes_of(site))


def test_masks_that_are_there_are_replaced_only_by_force(recorded, tmp_path):
    write_mask(tmp_path / "south.png", np.eye(6, 8, dtype=bool))
    with pytest.raises(SiteError, match="is there already; choose another folder, or --force"):
        command("mask", recorded, "--out", tmp_path)
    assert not (tmp_path / "north.png").exists()
    command("mask", recorded, "--out", tmp_path, "--force")
    assert (tmp_path / "north.png").exists()


def test_a_mask_of_another_size_names_file_and_camera(folder, plain, tmp_path):
    write_mask(tmp_path / "wide.png", np.eye(6, 9, dtype=bool))
    plain["cameras"][1]["mask"] = str(tmp_path / "wide.png")
    with pytest.raises(
        SiteError, match=r"cameras\[1\] \(south\): mask: .*wide.png is 9 x 6 pixels, its camera has 8 x 6"
    ):
        Site.load(folder.write(plain)).cameras()
