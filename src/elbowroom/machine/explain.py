"""Which pixels of depth images are the machine itself, and what else was seen near its body."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError, MachineError
from elbowroom.geometry import DepthCamera, VoxelGrid, bits, invert_rigid
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kernels.bits import Lattice
from elbowroom.geometry.parallel import spread
from elbowroom.machine.body import default_growth
from elbowroom.machine.buffers import zero_image
from elbowroom.machine.joint_state import Joints
from elbowroom.machine.kernels.draw import Canvas, View, draw, to_kind
from elbowroom.machine.kernels.explain import Tolerance, explain
from elbowroom.machine.kernels.returns import TILE, Around, mark_tiles
from elbowroom.machine.machine import Machine
from elbowroom.machine.rasterise import canvas, drawn_mesh, view_of
from elbowroom.machine.samples import body_samples

BALL_VOXEL_M = 0.07
"""The body is covered with balls of some 0.15 m, the clusters of its samples for voxels of this size."""
REACH_M = 0.1
"""Returns this much farther from the body are kept as well: it moves between frame and decision [m]."""
DRAWN_SHARE = 0.2
"""A fine machine is drawn with fewer triangles, to within this share of the tolerance, which is the less by it."""
RETURN_SIGMAS = 3.0
"""A return may lie this many sigmas nearer or farther than measured."""
NO_LATTICE = Lattice(nx=0, ny=0, nz=0, cubes_x=0, cubes_y=0, cubes_z=0, x0=0.0, y0=0.0, z0=0.0, edge=1.0)


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """What the machine explains of a set of depth images.

    Args:
        model_depth: by camera, float32, shape (height, width) [m, the camera's kind]: 0 where the pixel is
            not explained; else the depth up to which its ray is free, the model's depth in it, or beside the
            model's edge the nearest within the 3 x 3 pixels about it. In cameras with flying pixels also: infinity
            for a mixed pixel of the machine's edge, explained and free up to what it measured; below zero for one or
            two pixels that do not fit amid others that do or see farther, explained all the same and free up to what
            they measured or the absolute value; and next to nothing below zero for other pixels that the machine is
            about, which are not explained.
        unexplained_words: plane of the grid with every voxel, near the grown body, that may hold a return
            that the machine does not explain; such voxels must not be freed as body. Voxels farther from the
            body may be set too. None if no grid was given.
        decided_words: plane of voxels that become free as body whatever cameras say, so that a carve need not ask
            any of them, and says nothing of them; None: it asks of all.
    """

    model_depth: dict[str, NDArray[np.float32]]
    unexplained_words: Words | None
    decided_words: Words | None = None


def explain_frames(
    machine: Machine,
    cameras: Sequence[DepthCamera],
    depths: Sequence[NDArray[np.float32]],
    joints_per_camera: Sequence[Joints],
    tolerance_m: float = 0.01,
    tolerance_sigmas: float = 5.5,
    grid: VoxelGrid | None = None,
    growth_m: float | None = None,
) -> Explained:
    """Finds the pixels whose measured point lies on the machine's model.

    A valid depth d is explained if it lies between the least and the greatest depth that the model has within
    the 3 x 3 pixels about it, give or take `tolerance_m` + `tolerance_sigmas` * sigma(d). Where the model is
    not in these pixels, nothing is explained. A fine machine is drawn with fewer triangles, to within a fifth of
    `tolerance_m`, and what they may lie off is taken from it.

    A return must have neighbours like it to count as something else than the machine: one that stands alone says
    nothing of the voxels of the body, and behind the machine's edge, in a camera with flying pixels, it is a mixed
    pixel of the edge and explained.

    Args:
        machine: with all its links, unchecked ones too.
        cameras: without distortion.
        depths: for each camera, floating, shape (height, width) [m, its kind]; what is not a finite number
            above zero and within the camera's range is no return.
        joints_per_camera: for each camera, joint positions at its frame's time, by name [m or rad].
        tolerance_m, tolerance_sigmas: as above; not the margin of carving.
        grid: for `unexplained_words`; None: without.
        growth_m: by how much the body is grown where voxels are cleared [m]; None: half a voxel.

    Raises:
        CameraError: a camera has distortion.
        FrameError: an image of another size than its camera's, or not as many images or joints as cameras.
        MachineError: joints that are not possible, or a tolerance below zero.
    """
    if not (len(cameras) == len(depths) == len(joints_per_camera)):
        raise FrameError(
            f"explain_frames: {len(cameras)} cameras, {len(depths)} images and {len(joints_per_camera)} "
            "joint positions; must be as many of each"
        )
    if not (tolerance_m >= 0 and tolerance_sigmas >= 0):
        raise MachineError(f"tolerance is {tolerance_m} m + {tolerance_sigmas} sigmas, must be at least 0")
    views = [view_of(camera) for camera in cameras]
    images = [_image(camera, depth) for camera, depth in zip(cameras, depths, strict=True)]
    placed = _camera_from_links(machine, cameras, joints_per_camera)
    near_body = _Near(machine, grid, growth_m)
    mesh, bound_m = drawn_mesh(machine, DRAWN_SHARE * tolerance_m)
    canvases: deque[Canvas] = deque()
    tolerance = Tolerance(float(tolerance_m) - bound_m, float(tolerance_sigmas))

    def explain_one(n: int) -> NDArray[np.float32]:
        view = views[n]
        drawn = _spare_canvas(canvases, view)
        draw(mesh, placed[n], view, drawn)
        to_kind(view, drawn)
        model = zero_image(view.height, view.width)
        around = near_body.around(view, placed[n], cameras[n].world_from_camera)
        explain(view, images[n], drawn, tolerance, model, around)
        canvases.append(drawn)
        near_body.give_back(around)
        return model

    models = spread(explain_one, range(len(cameras)))
    return Explained(
        model_depth={camera.name: model for camera, model in zip(cameras, models, strict=True)},
        unexplained_words=near_body.words,
    )


class _Near:
    """Says where returns near the body are looked for, and collects them on a plane for each thread."""

    def __init__(self, machine: Machine, grid: VoxelGrid | None, growth_m: float | None) -> None:
        self._grid = grid
        self._planes: list[Words] = []
        self._spare: deque[Words] = deque()
        if grid is not None:
            growth = default_growth(grid) if growth_m is None else growth_m
            balls = body_samples(machine, BALL_VOXEL_M, unchecked=True)
            beyond = balls.cover_m + growth + np.sqrt(3) * grid.voxel_size_m + REACH_M
            self._balls = balls.clusters._replace(radius=balls.cluster_radius + beyond)

    def around(
        self, view: View, camera_from_link: NDArray[np.float64], world_from_camera: NDArray[np.float64]
    ) -> Around:
        """For one image: its tiles, and a plane that no other thread uses; without a grid no tiles."""
        if self._grid is None:
            nothing = np.zeros((0, 0))
            return Around(nothing, nothing, 0.0, world_from_camera, NO_LATTICE, np.zeros(0, dtype=np.uint64))
        tiles = (-(-view.height // TILE), -(-view.width // TILE))
        near, far = np.full(tiles, np.inf), np.zeros(tiles)
        mark_tiles(self._balls, camera_from_link, view, near, far)
        try:
            words = self._spare.pop()
        except IndexError:
            words = bits.empty(self._grid)
            self._planes.append(words)
        return Around(near, far, RETURN_SIGMAS, world_from_camera, bits.lattice(self._grid), words)

    def give_back(self, around: Around) -> None:
        """The plane may be used for another image."""
        self._spare.append(around.words)

    @property
    def words(self) -> Words | None:
        """The plane of all images; None without a grid."""
        if self._grid is None:
            return None
        union = bits.empty(self._grid)
        for plane in self._planes:
            union |= plane
        return union


def _image(camera: DepthCamera, depth: NDArray[np.float32]) -> NDArray[np.float32]:
    image = np.ascontiguousarray(depth, dtype=np.float32)
    if image.shape != (camera.height, camera.width):
        raise FrameError(
            f"frame of {camera.name}: image has shape {image.shape}, the camera delivers "
            f"{(camera.height, camera.width)}"
        )
    # as frames have it: what may be written is another type to numba, which would compile the kernel for it
    image = image.view()
    image.setflags(write=False)
    return image


def _camera_from_links(
    machine: Machine, cameras: Sequence[DepthCamera], joints_per_camera: Sequence[Joints]
) -> NDArray[np.float64]:
    """Where all links are for each camera at its frame's time, shape (cameras, links, 4, 4)."""
    by_record = {id(joints): machine.positions(joints) for joints in joints_per_camera}
    if any(row.ndim != 1 for row in by_record.values()):
        raise MachineError("explain_frames takes one position for each joint and camera, got arrays")
    positions = np.array([by_record[id(joints)] for joints in joints_per_camera])
    placed = machine.world_from_link_array(positions.reshape(len(cameras), len(machine.joint_names)))
    if not len(cameras):
        return placed
    return invert_rigid(np.stack([camera.world_from_camera for camera in cameras]))[:, None] @ placed


def _spare_canvas(wiped: deque[Canvas], view: View) -> Canvas:
    """An empty canvas: one that was wiped if there is one of this size."""
    try:
        spare = wiped.pop()
    except IndexError:
        return canvas(view.height, view.width)
    return spare if spare.inverse.shape == (view.height, view.width) else canvas(view.height, view.width)
