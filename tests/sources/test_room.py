"""A site opened for a run, with what the run says otherwise."""

import pytest

from elbowroom.errors import InputError
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.site import Site
from elbowroom.sources import Recorded, open_room
from elbowroom.sources.cameras import with_noise
from elbowroom.sources.simulated import Simulated


def refusal(site, **otherwise):
    with pytest.raises(InputError) as caught:
        open_room(site, **otherwise)
    return str(caught.value)


def test_a_run_may_say_otherwise_than_the_site():
    site = Site.simulated_room()
    room = open_room(site, voxel_size_m=0.2, rule="veto", detail="point", cameras=3, resolution=(40, 30))
    assert (room.grid.voxel_size_m, room.terms.rule, room.terms.detail) == (0.2, "veto", "point")
    assert [(camera.width, camera.height) for camera in room.cameras] == [(40, 30)] * 3
    assert isinstance(room.source, Simulated) and room.source.name == "simulator"
    as_it_is = open_room(site)
    assert as_it_is.terms == site.terms()


@pytest.fixture
def recorded(folder, plain):
    folder.image("rec/north/5000000.png", raw=1000)
    folder.image("rec/south/5000000.png", raw=1000)
    folder.image("rec/north/9000000.png", raw=1000)
    plain["recording"] = {"layout": "folder", "folder": "rec", "max_skew_ms": 1}
    return Site.load(folder.write(plain))


def test_a_recording_is_played_from_its_first_moment_each_time(recorded):
    room = open_room(recorded)
    assert isinstance(room.source, Recorded) and room.source.name == "reading"
    for _ in range(2):
        assert [snapshot.now_ns for snapshot in room.source] == [5_000_000, 9_000_000]
    assert room.snapshot(1).now_ns == 9_000_000
    with pytest.raises(InputError, match=r"^moment: 2 is not there; .* has 2 moments, from 0"):
        room.snapshot(2)


def test_what_does_not_go_with_the_room_is_refused_by_the_name_of_its_argument(recorded):
    for name, given in (("cameras", 3), ("resolution", (4, 3)), ("knocks", ["cam00:1deg"])):
        assert refusal(recorded, **{name: given}).startswith(f"{name}: for simulated rooms")
    assert refusal(recorded, joints={"turn": 0.0}).startswith("joints: ")
    simulated = Site.simulated_room()
    assert refusal(simulated, knocks=["cam99:1deg"]).startswith("knocks: nothing is called 'cam99'")
    assert refusal(simulated, knocks=["cam00"]).startswith("knocks: 'cam00' is no knock")


def test_a_room_without_a_machine_has_no_motions(recorded):
    with pytest.raises(InputError, match="without a machine there is no motion to check"):
        open_room(recorded).machine_and_motions()
    assert "no machine" in open_room(recorded).unasked


def test_cameras_that_a_simulated_room_lists_take_another_size_and_noise(folder, plain):
    plain["simulated"] = {"seed": 1}
    site = with_noise(Site.load(folder.write(plain)), "tof")
    room = open_room(site, resolution=(16, 12))
    listed = site.cameras()
    for camera, before in zip(room.cameras, listed, strict=True):
        assert camera.noise == NOISE_PRESETS["tof"] and camera.flying_pixels
        assert (camera.width, camera.height) == (2 * before.width, 2 * before.height)
        # the same corner of the image sees the same direction
        for a, b in ((camera, before),):
            x, y = a.intrinsics.normalised(a.width, a.height)
            u, v = b.intrinsics.normalised(b.width, b.height)
            assert x[:2].mean() == pytest.approx(u[0]) and y[-2:].mean() == pytest.approx(v[-1])
    with pytest.raises(InputError, match="lists its cameras"):
        open_room(site, cameras=3)
