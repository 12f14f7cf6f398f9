"""The machine as a depth camera would see it if nothing else were there."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.kept import kept
from elbowroom.geometry.noise import NoiseModel
from elbowroom.geometry.solids import is_closed
from elbowroom.machine.buffers import zero_image
from elbowroom.machine.joint_state import Joints
from elbowroom.machine.kernels.draw import Canvas, Mesh, View, draw, to_kind
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine
from elbowroom.machine.shape import Shape


def rasterise(machine: Machine, camera: DepthCamera, joints: Joints) -> NDArray[np.float32]:
    """Depth of the machine's surface along the ray through the centre of each pixel.

    Args:
        machine: what to draw; both sides of its triangles are seen.
        camera: without distortion; range and noise are left out.
        joints: one position for each joint, by name [m or rad].

    Returns:
        float32, shape (height, width) [m, the camera's kind]; infinity where the machine is not.

    Raises:
        CameraError: the camera has distortion.
        MachineError: joints that are not possible.
    """
    view = view_of(camera)
    world_from_link = machine.world_from_link_array(np.atleast_2d(machine.positions(joints)))[0]
    drawn = canvas(camera.height, camera.width)
    draw(mesh_of(machine), camera.camera_from_world @ world_from_link, view, drawn)
    to_kind(view, drawn)
    inverse: NDArray[np.float32] = drawn.inverse
    with np.errstate(divide="ignore"):
        return np.float32(1.0) / inverse


def view_of(camera: DepthCamera) -> View:
    """The camera as kernels take it.

    Raises:
        CameraError: the camera has distortion.
    """
    if camera.intrinsics.is_distorted:
        raise CameraError(f"camera {camera.name}: has distortion; bring image and camera to a pinhole first")
    k, noise = camera.intrinsics, camera.noise or NoiseModel(0.0)
    return View(
        width=int(camera.width),
        height=int(camera.height),
        fx=float(k.fx),
        fy=float(k.fy),
        cx=float(k.cx),
        cy=float(k.cy),
        radial=camera.depth_kind == "radial",
        min_depth=float(camera.min_depth_m),
        max_depth=float(camera.deepest_m),
        constant=float(noise.constant_m),
        linear=float(noise.linear),
        quadratic=float(noise.quadratic),
        offset=float(noise.offset_m),
        flying=bool(camera.flying_pixels),
    )


def canvas(height: int, width: int, inverse: NDArray[np.float32] | None = None) -> Canvas:
    """An empty image of inverse depth, in which no column of any row is drawn.

    Args:
        height, width: of the image [px].
        inverse: its memory, all zeros; None: new.
    """
    return Canvas(
        zero_image(height, width) if inverse is None else inverse,
        np.full(height, width, dtype=np.int64),
        np.full(height, -1, dtype=np.int64),
    )


def mesh_of(machine: Machine) -> Mesh:
    """All triangles that cameras see of the machine, as kernels take them; made once."""
    return _mesh(machine.as_seen.shape, 0.0)


def drawn_mesh(machine: Machine, bound_m: float) -> tuple[Mesh, float]:
    """The machine as it is drawn: a fine one with as few triangles as may be, made once.

    Args:
        machine: what to draw.
        bound_m: how far what is drawn may lie from its surface [m].

    Returns:
        The triangles, and how far they may lie from the surface at most, 0 for a machine that is drawn as it is [m].
    """
    shape = machine.as_seen.shape
    bound = shape.bound(bound_m)
    return _mesh(shape, bound), bound


@kept
def _mesh(shape: Shape, bound_m: float) -> Mesh:
    links = shape.within(bound_m)
    counts = np.cumsum([0] + [len(link.vertices) for link in links])
    centre = np.zeros((len(links), 3))
    radius = np.zeros(len(links))
    for row, link in enumerate(links):
        if link.has_geometry:
            centre[row] = (link.vertices.min(axis=0) + link.vertices.max(axis=0)) / 2
            radius[row] = np.linalg.norm(link.vertices - centre[row], axis=1).max()
    faces = [link.faces.astype(np.int64) + first for link, first in zip(links, counts, strict=False)]
    return Mesh(
        vertices=np.concatenate([link.vertices for link in links]),
        faces=np.concatenate(faces),
        vertex_start=counts,
        face_start=np.cumsum([0] + [len(link.faces) for link in links]),
        centre=centre,
        radius=radius,
        closed=np.array([_is_closed(link) for link in links]),
    )


def _is_closed(link: Link) -> bool:
    """Whether the link's surface is made of closed shells whose faces turn outwards."""
    return link.has_geometry and is_closed(link.vertices, link.faces)
