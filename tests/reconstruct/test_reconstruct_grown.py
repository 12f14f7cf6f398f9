"""What rectangles of tiles settle of grown boxes, the plain test of one voxel against all its pixels says as well."""

import numpy as np
import pytest
from numba import njit
from scipy.spatial.transform import Rotation

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.kernels.aged import sees_through_grown
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.grown import GROWN, look_grown
from elbowroom.reconstruct.kernels.place import Cube, blocks_of, box_in, voxels_of
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.views import fill
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes

ALL = np.uint64(0xFFFFFFFFFFFFFFFF)
SIZE = (128, 96)


@njit
def look(cameras, texels, asked, boxes, scratch):
    """Compiled: outside of that, a record whose fields share bytes cannot be handed on."""
    return look_grown(cameras[0], texels, asked, boxes, scratch[0])


def a_view(seed):
    """A random camera of a random room, as kernels take it, its images some while old; and the room's grid."""
    rng = np.random.default_rng(seed)
    grid = VoxelGrid(tuple(rng.uniform(-1, 1, 3)), (32, 32, 32), float(rng.uniform(0.02, 0.06)))
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    focal = float(rng.uniform(40, 90))
    camera = scenes.random_cameras(rng, grid, 1, size=SIZE, focal=focal, noise=noise)[0]
    frame = scenes.frame_of(camera, scenes.random_scene(rng, grid, balls=1, boxes=1, cameras=[camera]))
    margin = Margin(lateral_px=float(rng.choice((0, 0.5))))
    images = room_images([camera], [frame], {camera.name: float(rng.uniform(0.01, 0.2))})
    views, _ = fill(layout_of(grid, (camera,), margin), images, {}, [(0, SIZE[1], 0, SIZE[0])])
    return rng, grid, views


def cubes(rng, grid, many):
    """Some cubes of 16 voxels of a grid."""
    for corner in rng.integers(0, 17, (many, 3)):
        x, y, z = (float(a) for a in grid.origin_m + corner * grid.voxel_size_m)
        yield Cube(0, x, y, z, grid.voxel_size_m)


def lanes_of(word):
    """Which lanes of a word are set."""
    return [lane for lane in range(64) if int(word) >> lane & 1]


def still(views, boxes, lane):
    """What the plain test says of a voxel."""
    scratch = np.empty(1, VOXEL)
    return sees_through_grown(views.cameras[0], views.texels, box_in(boxes, lane), scratch[0])


def test_something_is_settled_either_way_of_voxels_and_of_blocks():
    """Else the laws below would hold of a look that says nothing."""
    found, scratch = np.zeros((2, 2), int), np.empty(1, GROWN)
    for seed in range(20):
        rng, grid, views = a_view(seed)
        for cube in cubes(rng, grid, 6):
            for row, boxes in enumerate((voxels_of(cube, int(rng.integers(64))), blocks_of(cube))):
                words = look(views.cameras, views.texels, ALL, boxes, scratch)
                if words[1] != ALL:  # not all of them beside the image
                    found[row] += [len(lanes_of(word)) for word in words]
    assert (found >= 100).all(), found


@pytest.mark.parametrize("seed", range(20))
def test_squares_and_tiles_settle_what_their_pixels_would(seed):
    """Of tiles that free nothing none is passed over for its depth."""
    rng, grid, views = a_view(seed)
    texels = views.texels._replace(
        trust_squares=np.zeros_like(views.texels.trust_squares),
        trust_tiles=np.zeros_like(views.texels.trust_tiles),
    )
    for cube in cubes(rng, grid, 6):
        boxes = voxels_of(cube, int(rng.integers(64)))
        found = [still(views, boxes, lane) for lane in range(64)]
        assert found == [still(views._replace(texels=texels), boxes, lane) for lane in range(64)]


@pytest.mark.parametrize("seed", range(12))
def test_what_is_settled_of_voxels_is_what_the_plain_test_says(seed):
    rng, grid, views = a_view(seed)
    scratch = np.empty(1, GROWN)
    for cube in cubes(rng, grid, 6):
        boxes = voxels_of(cube, int(rng.integers(64)))
        through, stopped = look(views.cameras, views.texels, ALL, boxes, scratch)
        assert not int(through) & int(stopped)
        assert all(still(views, boxes, lane) for lane in lanes_of(through))
        assert not any(still(views, boxes, lane) for lane in lanes_of(stopped))


@pytest.mark.parametrize("seed", range(12, 20))
def test_a_block_is_settled_as_all_its_voxels_are(seed):
    rng, grid, views = a_view(seed)
    scratch = np.empty(1, GROWN)
    for cube in cubes(rng, grid, 2):
        through, stopped = look(views.cameras, views.texels, ALL, blocks_of(cube), scratch)
        for word, expected in ((through, True), (stopped, False)):
            for block in lanes_of(word)[::5]:
                boxes = voxels_of(cube, block)
                assert {still(views, boxes, lane) for lane in range(64)} == {expected}


def test_a_block_at_the_cameras_plane_is_not_judged_by_pixels_beside_it():
    """Its near side may lie at the plane, and voxels of it well before the camera, seen through."""
    turned = [[-0.755, 0.3994, 0.5201], [0.1444, -0.6724, 0.726], [0.6397, 0.6232, 0.45]]
    turned = Rotation.from_matrix(turned).as_matrix()
    pose, edge, middle, focal, side = np.eye(4), 0.02, np.array([0.11833, -0.01863, 0.11251]), 1000.0, 2880
    pose[:3, :3] = turned.T
    lens = Intrinsics(focal, focal, (side - 1) / 2, (side - 1) / 2)
    camera = DepthCamera("near", side, side, pose, lens)
    depth = np.full((side, side), 3.0, np.float32)
    column, row = (middle[:2] * focal + (side - 1) / 2).astype(int)
    depth[row - 12 : row + 13, column - 12 : column + 13] = 0
    grid = VoxelGrid(tuple(turned.T @ middle - 6 * edge), (16, 16, 16), edge)
    images = room_images([camera], [DepthFrame("near", 0, depth)], {"near": 0.0439467})
    views, _ = fill(layout_of(grid, (camera,), Margin()), images, {}, [(0, side, 0, side)])
    cube, block = Cube(0, *(float(a) for a in grid.origin_m), edge), 21
    _, stopped = look(views.cameras, views.texels, ALL, blocks_of(cube), np.empty(1, GROWN))
    seen = [still(views, voxels_of(cube, block), lane) for lane in range(64)]
    assert any(seen) and not int(stopped) >> block & 1


def test_only_what_is_asked_is_settled_by_pixels():
    rng, grid, views = a_view(3)
    scratch = np.empty(1, GROWN)
    for cube in cubes(rng, grid, 4):
        boxes, asked = voxels_of(cube, 21), np.uint64(rng.integers(2**63))
        whole = look(views.cameras, views.texels, ALL, boxes, scratch)
        some = look(views.cameras, views.texels, asked, boxes, scratch)
        assert [int(word) & int(asked) for word in whole] == [int(word) & int(asked) for word in some]
