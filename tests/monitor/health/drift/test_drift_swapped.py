"""Two cameras that were exchanged are named so, though their views are alike; one that was turned never is."""

from itertools import combinations

import numpy as np
import pytest

from elbowroom.evaluate.faults.scene import PLACES, image_of, written_site
from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.drift.reference_file import load_references
from elbowroom.monitor.health.drift.watch import TURNS, Watch
from elbowroom.monitor.health.streams.cause import HealthCause
from elbowroom.monitor.health.streams.streams import Streams
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.site import Site
from reference.watch_twins import knocked

STEP_NS = 66_666_667
BEFORE = 6


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    folder = tmp_path_factory.mktemp("room")
    cameras = Site.load(written_site(folder, None, 60.0)).cameras()
    return cameras, load_references(folder / "reference.npz")


def causes_of(room, seen_by, passes):
    """What is said of which camera in each of some passes after some in which all is well.

    Args:
        room: cameras and references.
        seen_by: by camera's name, the camera whose view its images are of; others give their own.
        passes: how many.
    """
    cameras, references = room
    watch, streams = Watch(cameras, references), Streams(cameras, references=references)
    random, told = np.random.default_rng(1), []
    for number in range(BEFORE + passes):
        now_ns = (number + 1) * STEP_NS
        views: dict[str, DepthCamera] = seen_by if number >= BEFORE else {}
        frames = tuple(
            DepthFrame(each.name, now_ns, image_of(views.get(each.name, each), 0.01 * (number % 3), random))
            for each in cameras
        )
        snapshot = Snapshot(frames, None, now_ns=now_ns)
        sick = streams.knowing(streams.hear(snapshot), watch.hear(streams.usable(snapshot)))
        told.append({(each.cause, each.source) for each in sick})
    assert not set().union(*told[:BEFORE])
    return told[BEFORE:]


@pytest.mark.parametrize(("one", "other"), list(combinations(sorted(PLACES), 2)))
def test_two_that_were_exchanged_are_both_named_from_their_first_images_on(room, one, other) -> None:
    by_name = {camera.name: camera for camera in room[0]}
    told = causes_of(room, {one: by_name[other], other: by_name[one]}, 4)
    swapped = {(HealthCause.CAMERA_SWAPPED, name) for name in (one, other)}
    # the watch listens to a camera at each second pass; until it has, nothing else is said of them
    assert all(said == swapped for said in told[TURNS - 1 :]), told
    assert all(said <= swapped for said in told)


def test_they_are_named_so_on_and_on_though_the_watch_has_found_that_their_room_is_another(room) -> None:
    by_name = {camera.name: camera for camera in room[0]}
    for said in causes_of(room, {"cam4": by_name["cam6"], "cam6": by_name["cam4"]}, 30)[TURNS - 1 :]:
        assert said == {(HealthCause.CAMERA_SWAPPED, name) for name in ("cam4", "cam6")}


@pytest.mark.parametrize("name", sorted(PLACES))
@pytest.mark.parametrize("turn_deg", [-4, 30])
def test_one_that_was_turned_is_never_taken_for_another(room, name, turn_deg) -> None:
    by_name = {camera.name: camera for camera in room[0]}
    told = causes_of(room, {name: knocked(by_name[name], (0, turn_deg, 0))}, 8)
    said = set().union(*told)
    assert said and all(cause is not HealthCause.CAMERA_SWAPPED and of == name for cause, of in said), said
