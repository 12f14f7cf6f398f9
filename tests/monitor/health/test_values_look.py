"""The monitor's look at values: at the first moments at all images, then at one a pass."""

from dataclasses import replace

import numpy as np

from elbowroom.monitor.health.values_look import EVERY, FIRST, ValuesLook
from elbowroom.sensing import Snapshot
from reference import values_room as room


def snapshot(scene, **other):
    frames = [replace(frame, depth_m=other.get(frame.camera, frame.depth_m)) for frame in scene.frames]
    return Snapshot(tuple(frames))


def look_of(scene, **more):
    return ValuesLook(scene.grid, scene.cameras, scene.units_m, **more)


def test_images_as_they_should_be_are_passed_in_silence():
    scene = room.scene(noise_m=0.002)
    look = look_of(scene)
    assert all(look.hear(snapshot(scene)) == () for _ in range(FIRST + 5 * EVERY))


def test_a_unit_is_found_at_the_first_moment_and_stays():
    scene = room.scene(unit_m=0.00025)
    look = look_of(replace(scene, units_m=dict.fromkeys(scene.units_m, 0.001)))
    wrong = replace(scene, units_m=dict.fromkeys(scene.units_m, 0.001))
    for _ in range(FIRST + 5 * EVERY):
        (finding,) = look.hear(snapshot(wrong))
        assert finding.stops and finding.kind == "unit"


def test_a_sentinel_that_comes_later_is_found_within_a_round_and_forgotten_when_it_goes():
    scene = room.scene(noise_m=0.002)
    look = look_of(scene)
    for _ in range(FIRST):
        look.hear(snapshot(scene))
    depth = np.where(scene.frames[2].depth_m > 3.8, 10.0, scene.frames[2].depth_m)
    heard = [look.hear(snapshot(scene, sw=depth)) for _ in range(EVERY * len(room.EYES))]
    assert [(finding.kind, finding.about, finding.stops) for finding in heard[-1]] == [
        ("sentinel", ("sw",), True)
    ]
    healed = [look.hear(snapshot(scene)) for _ in range(EVERY * len(room.EYES))]
    assert healed[-1] == ()


def test_a_covered_camera_is_a_warning():
    scene = room.scene()
    look = look_of(scene)
    black = np.zeros((room.HEIGHT, room.WIDTH), np.float32)
    for _ in range(FIRST + 4 * EVERY):
        assert [(finding.about, finding.stops) for finding in look.hear(snapshot(scene, ne=black))] == [
            (("ne",), False)
        ]


def test_a_moment_without_frames_says_nothing():
    look = look_of(room.scene())
    assert all(look.hear(Snapshot(())) == () for _ in range(FIRST + 2))


def test_cameras_that_were_all_dark_at_the_start_do_not_stop_for_ever_and_are_looked_at_then():
    scene = room.scene(noise_m=0.002)
    black = np.zeros((room.HEIGHT, room.WIDTH), np.float32)
    dark = snapshot(scene, **dict.fromkeys(room.EYES, black))
    look = look_of(scene)
    for _ in range(FIRST + 2 * EVERY):
        assert any(finding.stops for finding in look.hear(dark))
    healed = [look.hear(snapshot(scene)) for _ in range(EVERY)]
    assert healed[-1] == ()


def test_a_unit_is_found_where_the_first_moments_were_dark_or_empty():
    scene = room.scene(unit_m=0.00025)
    wrong = replace(scene, units_m=dict.fromkeys(scene.units_m, 0.001))
    black = np.zeros((room.HEIGHT, room.WIDTH), np.float32)
    for early in (Snapshot(()), snapshot(wrong, **dict.fromkeys(room.EYES, black))):
        look = look_of(wrong)
        for _ in range(FIRST + 1):
            look.hear(early)
        heard = [look.hear(snapshot(wrong)) for _ in range(EVERY)]
        assert [(finding.kind, finding.stops) for finding in heard[-1]] == [("unit", True)]


def test_a_lens_of_another_size_is_said_from_the_beginning():
    scene = room.scene()
    wide = [replace(c, intrinsics=replace(c.intrinsics, cx=159.5, cy=119.5)) for c in scene.cameras]
    (finding,) = look_of(replace(scene, cameras=wide)).hear(snapshot(scene))
    assert finding.stops and finding.kind == "principal point"
