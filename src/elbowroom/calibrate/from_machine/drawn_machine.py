"""The machine's model drawn as a camera would see it, at a base that may still move."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.machine.kernels.draw import Canvas, draw
from elbowroom.machine.rasterise import canvas, mesh_of, view_of

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class DrawnMachine:
    """A machine to be drawn.

    Args:
        machine: its links.
        world_from_base: where it stands, shape (4, 4).
    """

    machine: Machine
    world_from_base: Array

    def image(self, camera: DepthCamera, base_from_links: Array) -> Canvas:
        """The machine in a pinhole camera's view.

        Args:
            camera: without distortion.
            base_from_links: shape (links, 4, 4).
        """
        drawing = canvas(camera.height, camera.width)
        camera_from_links = camera.camera_from_world @ self.world_from_base @ base_from_links
        draw(mesh_of(self.machine), camera_from_links, view_of(camera), drawing)
        return drawing

    def links_seen(self, camera: DepthCamera, base_from_links: Array) -> dict[str, int]:
        """Pixels in which each link is the nearest, by name; links without any are left out."""
        whole = self.image(camera, base_from_links).inverse
        mesh, found = mesh_of(self.machine), {}
        for row, link in enumerate(self.machine.links):
            only = mesh._replace(
                face_start=np.where(
                    np.arange(len(mesh.face_start)) <= row, mesh.face_start[row], mesh.face_start[row + 1]
                )
            )
            drawing = canvas(camera.height, camera.width)
            camera_from_links = camera.camera_from_world @ self.world_from_base @ base_from_links
            draw(only, camera_from_links, view_of(camera), drawing)
            count = int(((drawing.inverse > 0) & (drawing.inverse >= whole)).sum())
            if count:
                found[link.name] = count
        return found
