"""Small rooms made by hand: what is seen, what is hidden, edges of images, bad pixels, ages of frames."""

import numpy as np
import pytest

from elbowroom.errors import CameraError, EvidenceError, FrameError, GridError, InputError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct import Evidence, FreeSpace, Sight, carve, merge, reconstruct, resolve
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes

GRID = VoxelGrid((1.0, -0.5, -0.5), (20, 10, 10), 0.1)
WALL = scenes.Scene(boxes=np.array([[2.02, -5.0, -5.0, 2.08, 5.0, 5.0]]))
"""It stands across x, within the voxels of index 10."""
EMPTY = scenes.Scene()
DETAILS = ["footprint", "pixel", "point"]
details = pytest.mark.parametrize("detail", DETAILS)
kinds = pytest.mark.parametrize("kind", ["planar", "radial"])


def ahead(name="front", **more):
    """A camera at the origin that looks along x, with all of the grid in its image."""
    return scenes.camera_at(name, (0, 0, 0), (1, 0, 0), **({"size": (96, 72), "focal": 60.0} | more))


@details
@kinds
def test_point_behind_a_wall_is_unseen(detail, kind):
    camera = ahead(kind=kind)
    space = reconstruct(GRID, [camera], [scenes.frame_of(camera, WALL)], detail=detail)
    assert space.free[1:9].all()
    assert space.surface[10].any()
    assert not space.free[10].any()
    assert space.unseen[12:].all()
    assert not bits.unpack(space.disputed_words, GRID)[12:].any()


@details
@kinds
def test_a_camera_that_looks_away_frees_and_disputes_nothing(detail, kind):
    away = scenes.camera_at("away", (0, 0, 0), (-1, 0, 0), kind=kind)
    evidence = carve(GRID, [away], [scenes.frame_of(away, EMPTY)], detail=detail)
    assert not evidence.planes.any()
    assert not carve(GRID, [away], [], detail=detail).planes.any()
    assert not reconstruct(GRID, [away], [scenes.frame_of(away, EMPTY)], rule="any", detail=detail).free.any()


@details
def test_no_frames_at_all_free_nothing(detail):
    assert not reconstruct(GRID, [], [], detail=detail).free.any()
    blank = reconstruct(GRID, [ahead()], [], detail=detail)
    assert not blank.free.any()
    assert bits.unpack(blank.blind_words, GRID).all()


@details
@kinds
@pytest.mark.parametrize("pixel", [0.0, np.nan, np.inf, -np.inf, -1.0, 9.0])
def test_what_is_no_return_carves_nothing_and_is_blind(detail, kind, pixel):
    camera = ahead(kind=kind, max_depth_m=8.0)
    frame = DepthFrame("front", 0, np.full((72, 96), pixel, dtype=np.float32))
    space = reconstruct(GRID, [camera], [frame], detail=detail)
    assert not space.free.any()
    assert bits.unpack(space.blind_words, GRID).all()
    missing = reconstruct(GRID, [camera], [], detail=detail)
    np.testing.assert_array_equal(space.free_words, missing.free_words)
    np.testing.assert_array_equal(space.disputed_words, missing.disputed_words)


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@kinds
def test_a_voxel_that_the_edge_of_the_image_cuts_is_never_through(detail, kind):
    camera = scenes.camera_at("narrow", (0, 0, 0), (1, 0, 0), size=(31, 21), focal=60.0, kind=kind)
    free = reconstruct(GRID, [camera], [scenes.frame_of(camera, EMPTY)], detail=detail).free
    corners = scenes.corners_of(GRID)[..., None, :] + 0.1 * np.indices((2, 2, 2)).reshape(3, 8).T
    at = corners @ camera.camera_from_world[:3, :3].T
    k = camera.intrinsics
    u, v = k.fx * at[..., 0] / at[..., 2] + k.cx, k.fy * at[..., 1] / at[..., 2] + k.cy
    whole = ((u >= 0) & (u <= 30) & (v >= 0) & (v <= 20)).all(axis=-1)
    assert free.any()
    assert not (free & ~whole).any()


@details
def test_a_camera_inside_a_voxel_does_not_free_it(detail):
    grid = VoxelGrid((-0.5, -0.5, -0.5), (10, 10, 10), 0.1)
    camera = scenes.camera_at("inside", (0.04, 0.05, 0.06), (1, 0.05, 0.06), size=(96, 72), focal=40.0)
    space = reconstruct(grid, [camera], [scenes.frame_of(camera, EMPTY)], detail=detail)
    own = tuple(grid.index_of(camera.centre_in_world))
    assert not space.free[own] or detail == "point"
    assert not space.free[: own[0]].any()
    assert space.free[own[0] + 3 :, own[1], own[2]].all()


@details
@pytest.mark.parametrize("depth", [0.0, 50.0])
def test_an_image_of_one_pixel(detail, depth):
    lens = Intrinsics(fx=1.0, fy=1.0, cx=0.0, cy=0.0)
    camera = DepthCamera("one", 1, 1, scenes.looking_at((0, 0, 0), (1, 0, 0)), lens)
    frame = DepthFrame("one", 0, np.full((1, 1), depth, dtype=np.float32))
    space = reconstruct(GRID, [camera], [frame], detail=detail, margin=Margin(lateral_px=0.0))
    if detail != "point":
        assert not space.free.any()  # no voxel has its whole footprint in an image of one pixel
    assert space.free.any() == (depth > 0 and detail == "point")


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
def test_three_that_see_through_overrule_one_that_measured_and_two_do_not(detail):
    cameras = [ahead(f"c{n}") for n in range(4)]
    empty, wall = scenes.depth_of(cameras[0], EMPTY), scenes.depth_of(cameras[0], WALL)
    for through, free in ((1, False), (2, False), (3, True)):
        group = cameras[: through + 1]
        frames = [DepthFrame(c.name, 0, wall if n == 0 else empty) for n, c in enumerate(group)]
        # all in one place: as witnesses they are one, unless each is said to be one of its own
        space = reconstruct(GRID, group, frames, detail=detail, witness_angle_deg=0.0)
        assert space.free[10].all() == free
        assert space.free[10].any() == free
        assert not reconstruct(GRID, group, frames, detail=detail).free[10].any()
        assert reconstruct(GRID, group, frames, detail=detail, rule="majority").free[10].any() == (
            through > 1
        )
        assert not reconstruct(GRID, group, frames, detail=detail, rule="veto").free[10].any()


@details
def test_an_old_frame_is_a_missing_frame(detail):
    cameras = [ahead("young"), ahead("old"), ahead("unstamped"), ahead("future")]
    depth = scenes.depth_of(cameras[0], WALL)
    stamps = {"young": 1000, "old": 899, "unstamped": None, "future": 1101}
    frames = [DepthFrame(name, stamp, depth) for name, stamp in stamps.items()]
    limited = reconstruct(GRID, cameras, frames, detail=detail, now_ns=1000, max_age_ns=100)
    missing = reconstruct(GRID, cameras, frames[:1], detail=detail)
    for plane in ("free_words", "surface_words", "blind_words", "disputed_words"):
        np.testing.assert_array_equal(getattr(limited, plane), getattr(missing, plane))
    unlimited = reconstruct(GRID, cameras, frames, detail=detail, now_ns=1000)
    assert unlimited.free[5].any()
    assert not limited.free[5].any()
    at_the_limit = [
        DepthFrame(name, 1000 + by, depth) for name, by in zip(stamps, (0, -100, 100, 0), strict=True)
    ]
    same = reconstruct(GRID, cameras, at_the_limit, detail=detail, now_ns=1000, max_age_ns=100)
    np.testing.assert_array_equal(same.free_words, unlimited.free_words)


@pytest.mark.parametrize(("now", "age"), [(None, 5), (10, -1)])
def test_an_age_limit_that_cannot_be_applied_is_refused(now, age):
    with pytest.raises(InputError, match="max_age_ns"):
        reconstruct(GRID, [], [], now_ns=now, max_age_ns=age)


def test_what_is_refused():
    camera, twin = ahead(), ahead()
    frame = scenes.frame_of(camera, EMPTY)
    with pytest.raises(CameraError, match="front is there twice"):
        reconstruct(GRID, [camera, twin], [frame])
    with pytest.raises(FrameError, match="two frames of camera front"):
        reconstruct(GRID, [camera], [frame, frame])
    with pytest.raises(CameraError, match="camera back is unknown, known are front"):
        reconstruct(GRID, [camera], [DepthFrame("back", 0, frame.depth_m)])
    with pytest.raises(FrameError, match="96 x 72 pixels, this frame has 3 x 2"):
        reconstruct(GRID, [camera], [DepthFrame("front", 0, np.ones((2, 3), np.float32))])
    with pytest.raises(InputError, match="rule: 'most' is unknown, allowed are three"):
        reconstruct(GRID, [camera], [frame], rule="most")
    with pytest.raises(InputError, match="detail: 'voxel' is unknown, allowed are footprint"):
        reconstruct(GRID, [camera], [frame], detail="voxel")


def test_merging_refuses_unlike_grids_and_a_camera_named_twice():
    one = carve(GRID, [ahead()], [])
    with pytest.raises(EvidenceError, match="front named twice"):
        merge([one, one])
    with pytest.raises(EvidenceError, match="unlike grids"):
        merge([one, Evidence.nothing(VoxelGrid((0, 0, 0), (4, 4, 4), 0.1))])
    with pytest.raises(EvidenceError, match="nothing to merge"):
        merge([])


@pytest.mark.parametrize("rule", ["three", "majority", "veto", "any"])
def test_other_sensors_merge_like_cameras(rule):
    camera = ahead()
    through, surface = np.zeros((2, *GRID.shape), dtype=bool)
    through[:, :, 5:] = True
    surface[5, 5, :] = True
    lidar = Evidence.from_mask(GRID, "lidar", through, surface)
    complete = rule != "three"
    seen = carve(GRID, [camera], [scenes.frame_of(camera, WALL)], complete=complete)
    for order in ([lidar, seen], [seen, lidar]):
        space = resolve(merge(order), [camera], rule=rule)
        assert space.free[15, 5, 7]  # only the lidar sees behind the wall
        assert not space.free[15, 5, 2]
        assert not space.free[5, 5, 2] or rule == "any"
        assert space.free[5, 4, 2]
    with pytest.raises(EvidenceError, match="lidar named twice"):
        merge([lidar, lidar])
    with pytest.raises(GridError):
        Evidence.from_mask(GRID, "lidar", through[1:], surface[1:])


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
def test_explain_says_what_each_camera_saw(detail):
    front = ahead("front")
    cameras = [
        front,
        scenes.camera_at("behind", (5, 0, 0), (2, 0, 0), size=(96, 72), focal=60.0),
        scenes.camera_at("away", (0, 0, 0), (-1, 0, 0)),
        scenes.camera_at("dark", (0, 0, 0.01), (1, 0, 0), size=(96, 72), focal=60.0),
    ]
    thin = scenes.Scene(boxes=np.array([[2.0, -5.0, -5.0, 2.1, 0.05, 5.0]]))
    frames = [scenes.frame_of(camera, thin) for camera in cameras[:3]]
    space = reconstruct(GRID, cameras, frames, detail=detail)

    def sights(point):
        report = space.explain(point)
        return {seen.camera: seen.sight for seen in report.cameras}, report

    seen, report = sights((1.55, -0.25, 0.01))
    assert seen == {
        "front": Sight.THROUGH,
        "behind": Sight.HIDDEN,
        "away": Sight.OUTSIDE,
        "dark": Sight.BLIND,
    }
    assert report.state == "unseen"
    assert report.could_settle == ("dark", "behind")
    assert "front: sees through it" in str(report)
    assert [s.camera for s in report.cameras][-1] == "behind"
    by_name = {s.camera: s for s in report.cameras}
    assert by_name["front"].measured_m == pytest.approx(2.0, abs=0.01)
    assert by_name["front"].distance_m == pytest.approx(np.hypot(1.55, 0.25), abs=0.05)
    assert by_name["dark"].measured_m is None

    seen, report = sights((2.05, -0.2, 0.01))
    assert seen["front"] is Sight.SURFACE
    assert report.state == "surface"
    assert report.index == tuple(GRID.index_of((2.05, -0.2, 0.01)))
    seen, _ = sights((2.85, -0.3, 0.01))
    assert (seen["front"], seen["behind"]) == (Sight.HIDDEN, Sight.THROUGH)
    # the wall's end hides half of what lies behind
    seen, _ = sights((2.65, 0.06, 0.01))
    assert seen["front"] is Sight.EDGE


def test_explain_needs_frames_and_a_point_in_the_grid():
    without = FreeSpace.from_occupied(GRID, np.zeros(GRID.shape, dtype=bool))
    with pytest.raises(EvidenceError, match="no frames at hand"):
        without.explain((1.5, 0, 0))
    space = reconstruct(GRID, [ahead()], [])
    with pytest.raises(GridError, match="outside the grid"):
        space.explain((0, 0, 0))
    with pytest.raises(GridError, match="finite"):
        space.explain((np.nan, 0, 0))
    assert {s.sight for s in space.explain((1.55, 0, 0)).cameras} == {Sight.BLIND}
