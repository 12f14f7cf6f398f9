import numpy as np
import pytest
from PIL import Image

from elbowroom.cli import run
from elbowroom.view.draw.palette import CAMERA_INK

SMALL = ["--size", "160x120", "--voxel-size", "0.1"]


def test_a_picture_of_the_simulated_room_shows_all_parts(tmp_path, capsys) -> None:
    path = tmp_path / "all.png"
    assert run(["view", "--picture", str(path), *SMALL, "--moment", "4", "--sweep", "larm+"]) == 0
    pixels = np.array(Image.open(path)).reshape(-1, 3)
    assert pixels.shape[0] > 160 * 120
    assert "larm +" in capsys.readouterr().out
    # the camera's colour as it is in the legend, blocked space in its own, shaded
    assert (pixels == CAMERA_INK).all(axis=1).any()
    red, green, blue = pixels.astype(int).T
    assert ((blue > green + 40) & (red > green) & (blue > red + 20)).sum() > 20


def test_parts_can_be_left_out(tmp_path) -> None:
    path = tmp_path / "bare.jpg"
    hidden = [word for part in ("cameras", "blocked", "sweeps", "room") for word in ("--hide", part)]
    assert run(["view", "--picture", str(path), *SMALL, *hidden, "--view", "top"]) == 0
    assert (np.array(Image.open(path)) > 240).mean() > 0.6


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--picture", "a.bmp"], "no kind of picture"),
        (["--from", "1,2"], "--from"),
        (["--from", "1,2,nan"], "--from"),
        (["--to", "1,2,3"], "--to"),
        (["--view", "below"], "below"),
        (["--hide", "people"], "--hide"),
        (["--sweep", "larm"], "--sweep"),
        (["--size", "9000x10"], "size"),
        (["--size", "big"], "--size"),
    ],
)
def test_what_is_no_picture_is_said(tmp_path, monkeypatch, capsys, options, word) -> None:
    monkeypatch.chdir(tmp_path)
    wanted = ["--hide", "blocked", "--hide", "sweeps"] if "--hide" not in options else []
    assert run(["view", "--voxel-size", "0.2", *wanted, *options]) == 2
    assert word in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
