"""The machine as triangles in the room, and where a plane cuts them."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine


def cut_lines(triangles: NDArray[np.float64], normal: int, at_m: float) -> NDArray[np.float64]:
    """Where triangles cross a plane across an axis.

    Args:
        triangles: shape (n, 3, 3), world frame [m].
        normal: the axis, 0 to 2.
        at_m: where on it [m].

    Returns:
        Segments, shape (m, 2, 3), world frame [m].
    """
    height = triangles[:, :, normal] - at_m
    height = np.where(height == 0, 1e-12, height)
    above = (height > 0).sum(axis=1)
    crossing = (above == 1) | (above == 2)
    corners, height = triangles[crossing], height[crossing]
    # the corner that is alone on its side; both edges from it cross the plane
    alone = np.where(above[crossing, None] == 1, height > 0, height < 0).argmax(axis=1)
    row = np.arange(len(corners))
    ends = []
    for step in (1, 2):
        other = (alone + step) % 3
        share = height[row, alone] / (height[row, alone] - height[row, other])
        ends.append(corners[row, alone] + share[:, None] * (corners[row, other] - corners[row, alone]))
    return np.stack(ends, axis=1)


def triangles_of(machine: Machine, joints: Mapping[str, float]) -> NDArray[np.float64]:
    """All triangles of the machine, shape (n, 3, 3), world frame [m]."""
    world_from_links = machine.world_from_links(joints)
    placed = [np.zeros((0, 3, 3))]
    for link in machine.links:
        world_from_link = world_from_links[link.name]
        placed.append(link.triangles @ world_from_link[:3, :3].T + world_from_link[:3, 3])
    return np.concatenate(placed)
