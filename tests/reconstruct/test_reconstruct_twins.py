"""Kernels of carving against naive twins, bit for bit, on random rooms."""

import numpy as np
import pytest

from elbowroom.errors import EvidenceError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import RULES, Evidence, carve, merge, resolve
from elbowroom.reconstruct.evidence import Counts
from reference import reconstruct_footprint as footprint
from reference import reconstruct_scenes as scenes
from reference.reconstruct_pixel import DISPUTES, THROUGH, say_of_centre, say_of_voxel
from reference.reconstruct_rules import free_by_rule, planes_by_counting
from reference.reconstruct_views import images_of, says_of

SMALL = (24, 18)


def room_with_faults(seed, **more):
    """A small room whose images have holes; odd seeds have noise, flying pixels and an explained patch."""
    rng = np.random.default_rng(seed)
    if seed % 2:
        more |= {"noise": NoiseModel(0.003, 0.0, 0.002)}
    if "size" in more:
        grid = VoxelGrid(tuple(rng.uniform(-1, 1, 3)), tuple(int(n) for n in rng.integers(4, 9, 3)), 0.06)
        more["focal"] = float(rng.uniform(10, 40))
    else:
        grid = scenes.random_grid(rng)
    many = 5 if "size" in more else 4
    cameras = scenes.random_cameras(rng, grid, many if seed % 4 == 0 else 2, **more)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    frames = []
    for camera in cameras:
        depth = scenes.depth_of(camera, scene)
        depth[rng.random(depth.shape) < 0.02] = rng.choice((0, np.nan, np.inf, -1))
        frames.append(scenes.DepthFrame(camera.name, 0, depth))
    margin = Margin(lateral_px=float(rng.choice((0, 0.5, 1.2))), bias_m=float(rng.choice((0, 0.01))))
    model = None
    if seed % 4 == 1:
        depth = np.nan_to_num(frames[0].depth_m, nan=0, posinf=0).clip(0)
        patch = np.zeros_like(depth, dtype=bool)
        patch[: depth.shape[0] // 2, depth.shape[1] // 3 :] = True
        model = {cameras[0].name: np.where(patch, depth * np.float32(0.95), 0).astype(np.float32)}
    if seed % 5 == 2:
        frames = frames[:1]
    return grid, cameras, frames, margin, model


def compare(says, carved):
    """`carved(complete)` against what all cameras say of each voxel."""
    evidence = carved(True)
    np.testing.assert_array_equal(scenes.planes_of(evidence), planes_by_counting(says, complete=True))
    inside = np.unpackbits(bits.inside(evidence.grid).view(np.uint8), bitorder="little").astype(bool)
    for counts, kind in ((evidence.counts.through, THROUGH), (evidence.counts.disputes, DISPUTES)):
        assert counts.reshape(-1)[inside].sum() == (says & kind).astype(bool).sum()
    canonical = carved(False)
    np.testing.assert_array_equal(scenes.planes_of(canonical), planes_by_counting(says, complete=False))


@pytest.mark.parametrize("seed", range(12))
def test_pixel_detail_is_each_voxel_against_all_pixels(seed):
    grid, cameras, frames, margin, model = room_with_faults(seed, size=SMALL)
    says = says_of(grid, images_of(grid, cameras, frames, margin, model), say_of_voxel)
    more = {"margin": margin, "model_depth": model}
    for c, camera in enumerate(cameras):  # one that delivers nothing is blind wherever its image may be met
        if camera.name not in {frame.camera for frame in frames}:
            one = carve(grid, [camera], [], margin=margin, complete=True)
            silent = scenes.planes_of(one)
            assert not (says[c].astype(bool) & ~silent[3]).any()
            says[c] = np.where(silent[3], 2 | 8, 0)
    compare(says, lambda complete: carve(grid, cameras, frames, complete=complete, **more))


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 9])
def test_footprint_detail_is_the_window_test_of_blocks_and_voxels(seed):
    grid, cameras, frames, margin, model = room_with_faults(seed)
    says = footprint.says_of(grid, images_of(grid, cameras, frames, margin, model))
    more = {"detail": "footprint", "margin": margin, "model_depth": model}
    compare(says, lambda complete: carve(grid, cameras, frames, complete=complete, **more))
    assert says.any()


@pytest.mark.parametrize("seed", range(4))
def test_point_detail_is_the_test_of_centres(seed):
    grid, cameras, frames, margin, model = room_with_faults(seed, size=SMALL)
    says = says_of(grid, images_of(grid, cameras, frames, margin, model), say_of_centre)
    more = {"detail": "point", "margin": margin, "model_depth": model}
    compare(says, lambda complete: carve(grid, cameras, frames, complete=complete, **more))


def random_evidence(rng, grid, cameras, complete):
    """Random says of some cameras, and their evidence made one camera at a time."""
    says = rng.choice((0, 1, 2, 2 | 4, 2 | 8), size=(cameras, *grid.shape), p=(0.3, 0.4, 0.1, 0.1, 0.1))
    parts = []
    for n, say in enumerate(says):
        planes = np.zeros((6, bits.word_count(grid)), dtype=np.uint64)
        for plane, kind in ((0, 1), (3, 2), (4, 4), (5, 8)):
            planes[plane] = bits.pack(say & kind > 0, grid)
        counts = None
        if complete:
            counts = Counts(
                *(np.unpackbits(planes[p].view(np.uint8), bitorder="little").reshape(-1, 64) for p in (0, 3))
            )
        parts.append(Evidence(grid, (f"c{n}",), planes, bits.empty(grid), counts))
    return says, parts


@pytest.mark.parametrize("complete", [False, True])
@pytest.mark.parametrize("cameras", [1, 2, 3, 6])
def test_merging_counts_cameras_in_any_grouping(cameras, complete):
    rng = np.random.default_rng(cameras)
    grid = VoxelGrid((0, 0, 0), (5, 9, 17), 0.1)
    says, parts = random_evidence(rng, grid, cameras, complete)
    whole = merge(parts)
    np.testing.assert_array_equal(scenes.planes_of(whole), planes_by_counting(says, complete))
    order = rng.permutation(cameras)
    split = int(rng.integers(1, cameras + 1))
    groups = [[parts[n] for n in order[:split]], [parts[n] for n in order[split:]]]
    again = merge([merge(group) for group in groups[::-1] if group])
    np.testing.assert_array_equal(again.planes, whole.planes)
    assert again.cameras == whole.cameras
    if complete:
        np.testing.assert_array_equal(again.counts.through, whole.counts.through)
        np.testing.assert_array_equal(again.counts.disputes, whole.counts.disputes)


@pytest.mark.parametrize("rule", RULES)
def test_rules_are_counts_of_cameras(rule):
    grid = VoxelGrid((0, 0, 0), (5, 9, 17), 0.1)
    says, parts = random_evidence(np.random.default_rng(3), grid, 5, complete=True)
    space = resolve(merge(parts), [], rule=rule)
    np.testing.assert_array_equal(space.free, free_by_rule(says, rule))
    assert (space.free ^ space.surface ^ space.unseen).all()
    assert not (space.surface & space.unseen).any()


@pytest.mark.parametrize("rule", ["majority", "veto", "any"])
def test_rules_that_count_refuse_evidence_without_counts(rule):
    grid = VoxelGrid((0, 0, 0), (4, 4, 4), 0.1)
    with pytest.raises(EvidenceError, match="complete=True"):
        resolve(Evidence.nothing(grid), [], rule=rule)
