"""The site files in examples/, on the recordings that they are for."""

from pathlib import Path

import numpy as np
import pytest

from elbowroom.errors import SiteError
from elbowroom.reconstruct import reconstruct
from elbowroom.site import SIMULATED_ROOM, Site
from elbowroom.site.notes import notes_of
from elbowroom.sources import check_images, excluded_frames, moments

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
RECORDINGS = {
    # cameras, moments, share of pixels with a return (lowest and highest over the recording)
    "sevenscenes": (32, 1, 0.5, 1.0),
    "piv_table_2cam": (2, 11, 0.5, 1.0),
    "apc_wrist_multiview": (15, 1, 0.25, 0.5),
    "kinect_board_2cam": (2, 1, 0.3, 1.0),
}


def test_every_example_is_named_here_and_explained():
    names = {path.stem for path in EXAMPLES.glob("*.yaml")}
    assert names == {*RECORDINGS, "kinect_board_2cam_calibration", "simulated_room", "thesis_room"}
    readme = (EXAMPLES / "README.md").read_text()
    assert all(f"`{name}.yaml`" in readme for name in names)


def test_the_simulated_room_of_the_examples_is_the_packages_own():
    assert (EXAMPLES / "simulated_room.yaml").resolve() == SIMULATED_ROOM.resolve()


@pytest.mark.parametrize("name", RECORDINGS)
def test_without_the_recording_it_is_valid_and_says_what_is_absent(name, tmp_path, monkeypatch):
    monkeypatch.setenv("ELBOWROOM_DATA", str(tmp_path))
    site = Site.load(EXAMPLES / f"{name}.yaml")
    assert site.grid().size > 100_000
    with pytest.raises(SiteError, match=f"no folder {tmp_path}/{name} .*set ELBOWROOM_DATA to where it lies"):
        list(moments(site))


@pytest.mark.parametrize("name", RECORDINGS)
def test_the_recording_is_read_as_the_site_says(name, example_site):
    cameras, count, lowest, highest = RECORDINGS[name]
    site = Site.load(example_site(name))
    assert len(site.cameras()) == cameras
    assert check_images(site) == (count, cameras * count)
    first = next(moments(site))
    assert [frame.camera for frame in first.frames] == [camera.name for camera in site.cameras()]
    returned = np.mean([(frame.depth_m > 0).mean() for frame in first.frames])
    assert lowest < returned < highest
    assert site.max_age_ns is None and "frames have no times: no limit on their age" in notes_of(site)


@pytest.mark.parametrize("name", RECORDINGS)
def test_most_of_what_was_measured_lies_in_the_grid(name, example_site):
    """1st to 99th percentile per axis, grown: what lies outside on six sides is little."""
    site = Site.load(example_site(name))
    inside, total = 0, 0
    for camera, frame in zip(site.cameras(), next(moments(site)).frames, strict=True):
        depth = frame.depth_m[::4, ::4]
        valid = (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m)
        points = camera.points_in_world(frame.depth_m)[::4, ::4][valid]
        inside += site.grid().contains(points).sum()
        total += len(points)
    assert inside / total > 0.97


def test_sevenscenes_keeps_eight_views_for_checking(example_site):
    site = Site.load(example_site("sevenscenes"))
    kept = [camera.name for camera, _ in excluded_frames(site)]
    assert kept == [f"frame-{n:06d}" for n in (100, 225, 350, 475, 600, 725, 850, 950)]
    assert not {camera.name for camera in site.cameras()} & set(kept)
    assert any("32 poses were off a rotation" in note for note in notes_of(site))


def test_where_most_pixels_are_invalid_nothing_is_free(example_site):
    """apc_wrist_multiview: empty lines run through all that was measured, every few pixels."""
    site = Site.load(example_site("apc_wrist_multiview"))
    frames = next(moments(site)).frames
    space = reconstruct(
        site.grid(0.02),
        cameras=site.cameras(),
        frames=frames,
        rule="any",
        detail=site.detail,
        margin=site.margin(),
    )
    assert not space.free.any()
    assert space.surface.mean() > 0.01
