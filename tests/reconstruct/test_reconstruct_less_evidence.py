"""Less evidence never adds free space, nor makes a block one that may be overridden."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from elbowroom.geometry import VoxelGrid, bits, parallel
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import LAWFUL, carve, merge, reconstruct, resolve
from elbowroom.reconstruct.terms import WITNESS_ANGLE_DEG
from elbowroom.reconstruct.witnesses import witnesses
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened

FEW = settings(derandomize=True, max_examples=30)
rooms = st.integers(0, 10**6)
some_ways = st.sets(st.sampled_from(WAYS), min_size=1)


def a_room(seed, cameras=None):
    """A random room with frames at NOW; in half of the rooms cameras have noise and filter flying pixels."""
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    rng, grid, group, _, frames = scenes.random_room(seed, cameras, noise=noise, flying_pixels=seed % 3 != 0)
    return rng, grid, group, [DepthFrame(frame.camera, NOW, frame.depth_m) for frame in frames]


def overridable(space):
    """Blocked voxels that an operator may be allowed to drive into: nobody saw a surface, nobody disputes."""
    said = space.surface_words | space.blind_words | space.disputed_words
    return bits.unpack(space.blocked_words & ~said, space.grid)


def assert_no_milder(weak, full):
    assert not (weak.free & ~full.free).any()
    assert not (overridable(weak) & ~full.free & ~overridable(full)).any()


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@pytest.mark.parametrize("rule", LAWFUL)
@FEW
@given(seed=rooms, ways=some_ways)
def test_less_evidence_never_adds_free_space(detail, rule, seed, ways):
    rng, grid, cameras, frames = a_room(seed)
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, ways)
    same = {"rule": rule, "detail": detail, "now_ns": NOW, "max_age_ns": AGE}
    full = reconstruct(grid, cameras, frames, margin=margin, **same)
    weak = reconstruct(grid, cameras, fewer, margin=wider, **same)
    assert_no_milder(weak, full)


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@pytest.mark.parametrize("rule", LAWFUL)
@FEW
@given(seed=rooms)
def test_evidence_of_a_group_that_is_lost_never_adds_free_space(detail, rule, seed):
    rng, grid, cameras, frames = a_room(seed)
    # cameras that are one witness cannot be carved apart
    assume(not witnesses(grid, tuple(cameras), WITNESS_ANGLE_DEG))
    complete = rule == "majority"
    parts = [
        carve(grid, [camera], [frame], detail=detail, complete=complete)
        for camera, frame in zip(cameras, frames, strict=True)
    ]
    kept = [part for part in parts if rng.random() < 0.6] or parts[:1]
    full = resolve(merge(parts), cameras, rule=rule, detail=detail)
    weak = resolve(merge(kept), cameras, rule=rule, detail=detail)
    assert_no_milder(weak, full)
    missing = [f for f, p in zip(frames, parts, strict=True) if p in kept]
    np.testing.assert_array_equal(
        weak.free, reconstruct(grid, cameras, missing, rule=rule, detail=detail).free
    )


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
def test_widening_the_margin_step_by_step_only_ever_takes_space(detail):
    for seed in (1, 7, 378, 398, 509):
        rng, grid, cameras, frames = a_room(seed)
        margin = some_margin(rng)
        before = reconstruct(grid, cameras, frames, detail=detail, margin=margin)
        for way in [way for way in WAYS if way.startswith("widen")] * 3:
            _, margin = weakened(rng, frames, margin, {way})
            after = reconstruct(grid, cameras, frames, detail=detail, margin=margin)
            assert_no_milder(after, before)
            before = after


@pytest.mark.parametrize("cells", range(8, 36, 3))
def test_what_lies_behind_a_speck_is_no_freer_by_a_wider_margin_where_neighbours_see_past_the_room(cells):
    """A camera of coarse pixels: what they measured less a pixel's pitch may lie in the room again."""
    grid = VoxelGrid((0.5, -0.2, -0.2), (cells, 4, 4), 0.1)
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0), size=(16, 12), focal=6.0, flying_pixels=True)
    depth = np.full((12, 16), 9.0, dtype=np.float32)
    depth[6, 8] = 0.0
    before = reconstruct(grid, [camera], [DepthFrame("c", 0, depth)])
    for quadratic in (0.01, 0.03, 0.1, 0.3):
        after = reconstruct(
            grid, [camera], [DepthFrame("c", 0, depth)], margin=Margin(range_quadratic=quadratic)
        )
        assert_no_milder(after, before)
        before = after


def test_veto_is_rightly_called_unlawful():
    """Where one camera measures a surface that another overlooks, losing the first one frees the surface."""
    assert "veto" not in LAWFUL
    for seed in range(60):
        _, grid, cameras, frames = a_room(seed, cameras=4)
        full = reconstruct(grid, cameras, frames, rule="veto", detail="point")
        weak = reconstruct(grid, cameras, frames[1:], rule="veto", detail="point")
        if (weak.free & ~full.free).any():
            return
    raise AssertionError("no room in which veto breaks the law")


@FEW
@given(seed=rooms, detail=st.sampled_from(["footprint", "pixel", "point"]), complete=st.booleans())
def test_order_grouping_and_threads_leave_the_same_bits(seed, detail, complete):
    rng, grid, cameras, frames = a_room(seed)
    same = {"detail": detail, "complete": complete}
    with parallel.threads(1):
        whole = carve(grid, cameras, frames, **same)
    order = rng.permutation(len(cameras))
    split = int(rng.integers(len(cameras) + 1))
    with parallel.threads(3):
        again = carve(grid, [cameras[n] for n in order], frames[::-1], **same)
    groups = [order[:split], order[split:]]
    merged = merge(
        [carve(grid, [cameras[n] for n in g], [frames[n] for n in g], **same) for g in groups if len(g)]
    )
    for other in (again, merged):
        np.testing.assert_array_equal(other.planes, whole.planes)
        assert other.cameras == whole.cameras
        if complete:
            np.testing.assert_array_equal(other.counts.through, whole.counts.through)
            np.testing.assert_array_equal(other.counts.disputes, whole.counts.disputes)


@FEW
@given(seed=rooms, detail=st.sampled_from(["footprint", "pixel", "point"]))
def test_a_voxel_that_no_camera_could_see_is_never_free(seed, detail):
    _, grid, cameras, frames = a_room(seed)
    space = reconstruct(grid, cameras, frames, rule="any", detail=detail)
    corners = scenes.corners_of(grid)[..., None, :] + grid.voxel_size_m * np.array(
        [[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )
    could_see = np.zeros(grid.shape, dtype=bool)
    for camera, frame in zip(cameras, frames, strict=True):
        at = corners @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]
        k = camera.intrinsics
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = k.fx * at[..., 0] / at[..., 2] + k.cx, k.fy * at[..., 1] / at[..., 2] + k.cy
        ahead = (at[..., 2] > 0).any(axis=-1)
        inside = (u.max(-1) > -0.5) & (u.min(-1) < camera.width - 0.5)
        inside &= (v.max(-1) > -0.5) & (v.min(-1) < camera.height - 0.5)
        reach = frame.depth_m.max()
        near = at[..., 2].min(-1) if camera.depth_kind == "planar" else np.linalg.norm(at, axis=-1).min(-1)
        could_see |= ahead & inside & (near < reach)
    assert not (space.free & ~could_see).any()
