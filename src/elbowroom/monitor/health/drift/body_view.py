"""One camera's look at the machine's body, at a coarser pitch than its image."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, Intrinsics, invert_rigid
from elbowroom.geometry.lens import distorted, usable_radius
from elbowroom.machine import Machine
from elbowroom.machine.kernels.draw import View
from elbowroom.machine.rasterise import canvas, drawn_mesh, view_of
from elbowroom.monitor.health.drift.kernels.body import Found, Raw, Shown, draw_links, surface_spots
from elbowroom.monitor.health.drift.kernels.watch import LEAST_SIGMA_M

WIDTH_PX = 160
"""The image is looked at in steps, so that about so many columns are left."""
MOST_SPOTS = 1000
GATE_M = 0.12
DRAWN_M = 0.001
"""A fine machine is drawn with fewer triangles, to within so much; a link is off by 15 mm before it is named [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class BodySpots:
    """Where one image shows the machine's surface against where its joints say it is.

    Args:
        link: number of the link, shape (n,).
        point_in_link, normal_in_link: on the model, shape (n, 3) [m], the link's frame.
        offset_m: how much nearer to the camera the surface is seen, along the normal [m].
        sigma_m: of one return, along the normal [m].
    """

    link: NDArray[np.int64]
    point_in_link: NDArray[np.float64]
    normal_in_link: NDArray[np.float64]
    offset_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]


class BodyView:
    """A pinhole view in steps of whole pixels of a camera, distorted or not.

    Args:
        camera: of the room.
        machine: what is looked at.
    """

    def __init__(self, camera: DepthCamera, machine: Machine) -> None:
        step = max(1, camera.width // WIDTH_PX)
        width, height, k = camera.width // step, camera.height // step, camera.intrinsics
        pinhole = DepthCamera(
            camera.name,
            width,
            height,
            camera.world_from_camera,
            Intrinsics(k.fx / step, k.fy / step, (k.cx - step // 2) / step, (k.cy - step // 2) / step),
            noise=camera.noise,
            min_depth_m=camera.min_depth_m,
            max_depth_m=camera.max_depth_m,
        )
        self.camera, self.machine = camera, machine
        self._view: View = view_of(pinhole)
        x, y = np.meshgrid(*pinhole.intrinsics.normalised(width, height))
        radius = np.hypot(x, y)
        u, v = distorted(k, x, y)
        u, v = np.round(u), np.round(v)
        inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        inside &= radius <= (usable_radius(k, float(radius.max())) if k.is_distorted else np.inf)
        self._raw = Raw(
            np.where(inside, v * camera.width + u, -1).astype(np.int64),
            np.sqrt(1 + radius**2) if camera.depth_kind == "radial" else np.ones_like(x),
        )
        self._canvas = canvas(height, width)
        size = (height, width)
        self._shown = Shown(np.zeros(size, dtype=np.float32), np.zeros(size, dtype=np.int16))
        self._found = Found(np.zeros(MOST_SPOTS, dtype=np.int64), np.zeros((MOST_SPOTS, 8)))

    def look(self, depth_m: NDArray[np.float32], world_from_link: NDArray[np.float64]) -> BodySpots:
        """What the image shows of the machine.

        Args:
            depth_m: raw image, shape (height, width) [m, the camera's kind].
            world_from_link: where the joints say that the links are, shape (links, 4, 4).
        """
        camera_from_link = self.camera.camera_from_world @ world_from_link
        mesh, _ = drawn_mesh(self.machine, DRAWN_M)
        draw_links(mesh, camera_from_link, self._view, self._canvas, self._shown)
        n = surface_spots(self._view, self._shown, depth_m.ravel(), self._raw, GATE_M, self._found)
        link, numbers = self._found.link[:n].copy(), self._found.numbers[:n]
        link_from_camera = invert_rigid(camera_from_link)[link]
        rotation = link_from_camera[:, :3, :3]
        return BodySpots(
            link,
            np.einsum("nij,nj->ni", rotation, numbers[:, 0:3]) + link_from_camera[:, :3, 3],
            np.einsum("nij,nj->ni", rotation, numbers[:, 3:6]),
            numbers[:, 6].copy(),
            np.maximum(numbers[:, 7], LEAST_SIGMA_M),
        )
