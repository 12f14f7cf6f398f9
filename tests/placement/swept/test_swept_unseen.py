"""What motions sweep and nobody sees: by link, at the images' edges, and where one more camera would help."""

import json
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits, looking_at
from elbowroom.machine.body import body_words
from elbowroom.motion import Motion
from elbowroom.placement import FixedRoom
from elbowroom.placement.swept.advice import one_more
from elbowroom.placement.swept.picture import swept_picture
from elbowroom.placement.swept.swept import swept_by_link
from elbowroom.placement.swept.unseen import swept_of
from elbowroom.simulate import Solid
from elbowroom.simulate.shapes import box, join
from reference import motion_machines as machines
from reference.motion_machines import HOME

GRID = VoxelGrid.covering((-1.0, -1.5, 0.0), (2.0, 1.5, 1.5), 0.1)
MOTIONS = [Motion("slide", 1, 0.1, reach=0.5), Motion("turn", 1, 0.1, reach=0.5)]
LENS = Intrinsics(fx=80, fy=80, cx=79.5, cy=59.5)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def camera_at(place, look_at, name="camera"):
    return DepthCamera(name, 160, 120, looking_at(place, look_at), LENS)


def around(height_m):
    return [
        camera_at((3 * x, 3 * y, height_m), (0.3, 0, 0.6), f"{x}{y}")
        for x, y in ((1, 0.1), (-1, 0.1), (0, 1), (0, -1))
    ]


def room_of(*boxes):
    solids = tuple(
        Solid(f"box {n}", join([box(*corners)]), np.eye(4), is_static=True) for n, corners in enumerate(boxes)
    )
    return FixedRoom(solids, (), np.array([[-3.5, -3.5, -0.5], [3.5, 3.5, 3.0]]))


def test_a_link_sweeps_what_its_surface_comes_through_and_not_where_it_stands(arm):
    swept = swept_by_link(GRID, arm, HOME, MOTIONS)
    body = bits.unpack(body_words(arm, HOME, GRID), GRID)
    moved = set(arm.moved_links("slide")) | set(arm.moved_links("turn"))
    assert set(swept) <= moved and "hand" in swept
    assert not any((voxels & body).any() for voxels in swept.values())
    # every voxel about a point of the hand halfway along the slide is swept, or was its own
    half = {**HOME, "slide": HOME["slide"] + 0.25}
    pose = arm.world_from_links(half)["hand"]
    hand = arm.links[arm.link_names.index("hand")]
    points = hand.vertices @ pose[:3, :3].T + pose[:3, 3]
    for index in GRID.index_of(0.999 * points + 0.001 * points.mean(axis=0)):
        assert swept["hand"][tuple(index)] or body[tuple(index)]


def test_cameras_all_round_see_all_and_none_see_nothing(arm):
    found = swept_of(GRID, around(2.5), arm, MOTIONS, [HOME])
    assert found.unseen_pct < 3 and found.warnings == ()
    nobody = swept_of(GRID, [camera_at((3, 0, 1), (6, 0, 1))], arm, MOTIONS, [HOME])
    assert nobody.unseen_pct == 100 and "no camera has anything" in nobody.warnings[0]
    assert all(link.no_image == link.voxels for link in nobody.links)


def test_more_cameras_never_see_less_of_any_link_whatever_their_order(arm):
    cameras = around(1.2)
    before = {link.link: 100.0 for link in swept_of(GRID, cameras[:1], arm, MOTIONS, [HOME]).links}
    for count in range(1, 5):
        found = swept_of(GRID, cameras[:count], arm, MOTIONS, [HOME])
        turned = swept_of(GRID, cameras[:count][::-1], arm, MOTIONS, [HOME])
        shares = {link.link: link.unseen_pct for link in found.links}
        assert shares == {link.link: link.unseen_pct for link in turned.links}
        assert all(shares[name] <= before[name] for name in shares)
        before = shares


def test_a_wall_between_hides_and_the_machine_hides(arm):
    camera = camera_at((-3, 0, 0.6), (0, 0, 0.6))
    open_room, walled = (
        room_of(((3.3, -3.4, -0.4), (3.4, 3.4, 2.9))),
        room_of(((-1.6, -1.4, 0), (-1.5, 1.4, 2.9))),
    )
    seen = swept_of(GRID, [camera], arm, MOTIONS, [HOME], open_room)
    assert 0 < seen.unseen_pct < 100 and sum(link.hidden for link in seen.links) > 0
    assert swept_of(GRID, [camera], arm, MOTIONS, [HOME], walled).unseen_pct == 100


@pytest.mark.parametrize(
    ("side", "words"), [(1, "upper edge of all images"), (-1, "lower edge of all images")]
)
def test_images_that_end_below_or_above_the_machine_are_said(arm, side, words):
    everything = swept_of(GRID, around(2.5), arm, MOTIONS, [HOME])
    layers = np.flatnonzero((everything.swept > 0).any(axis=(0, 1)))
    middle = float(GRID.centre_of((0, 0, layers.mean()))[2])
    # level images, of which all on one side of the middle is cut off
    rows = 60
    half = replace(LENS, cy=-0.5 if side > 0 else rows - 0.5)
    level = [
        replace(camera_at((x, 0, middle), (0, 0, middle)), name=f"{x}", height=rows, intrinsics=half)
        for x in (3, -3)
    ]
    found = swept_of(GRID, level, arm, MOTIONS, [HOME])
    assert [words in said for said in found.warnings] == [True]


def test_the_camera_that_is_advised_sees_what_is_said(arm):
    room = room_of(((-3.4, -3.4, -0.4), (3.4, 3.4, -0.3)))
    found = swept_of(GRID, [camera_at((-3, 0, 0.6), (0, 0, 0.6))], arm, MOTIONS, [HOME], room)
    more = one_more(found, arm, room)
    assert more is not None and 0 < more.sees_pct <= 100
    both = [camera_at((-3, 0, 0.6), (0, 0, 0.6)), camera_at(more.place_m, more.look_at_m, "more")]
    after = swept_of(GRID, both, arm, MOTIONS, [HOME], room)
    assert after.unseen.sum() == pytest.approx(found.unseen.sum() * (1 - more.sees_pct / 100), abs=2)
    nothing_left = swept_of(GRID, around(2.5), arm, MOTIONS, [HOME], room)
    assert nothing_left.unseen_pct >= 1 or one_more(nothing_left, arm, room) is None
    assert swept_picture(found, (both[0],), room, "y", "room").size[0] > 300
    assert json.dumps(found.row())
