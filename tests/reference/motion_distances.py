"""Distances to boxes of voxels, every pair of them looked at."""

import numpy as np
from scipy.spatial import ConvexHull


def to_boxes(points, grid, marked):
    """The least distance of some points to the boxes of marked voxels; infinite if there are none."""
    corners = grid.lower_m + np.argwhere(marked) * grid.voxel_size_m
    if not len(corners):
        return np.inf
    nearest = np.clip(points[:, None], corners, corners + grid.voxel_size_m)
    return float(np.linalg.norm(nearest - points[:, None], axis=-1).min())


def to_outside(points, grid):
    """The least distance of some points to what lies outside the grid."""
    return float(max(0.0, min((points - grid.lower_m).min(), (grid.upper_m - points).min())))


def convex_to_boxes(vertices, faces, grid, marked):
    """The least distance of a convex solid to the boxes of marked voxels, exact (coal); 0 where a corner lies in it.

    `vertices`, `faces`: its surface where it is, shapes (n, 3) and (m, 3).
    """
    import coal

    sides = ConvexHull(vertices).equations
    solid = coal.BVHModelOBBRSS()
    solid.beginModel(len(faces), len(vertices))
    for face in faces:
        solid.addTriangle(*vertices[face])
    solid.endModel()
    box, here = coal.Box(*[grid.voxel_size_m] * 3), coal.Transform3s.Identity()
    least = np.inf
    for index in np.argwhere(marked):
        corners = grid.lower_m + (index + np.indices((2, 2, 2)).reshape(3, -1).T) * grid.voxel_size_m
        if (corners @ sides[:, :3].T + sides[:, 3] <= 0).all(axis=1).any():
            return 0.0
        middle = coal.Transform3s(np.eye(3), grid.lower_m + (index + 0.5) * grid.voxel_size_m)
        least = min(
            least, coal.distance(solid, here, box, middle, coal.DistanceRequest(), coal.DistanceResult())
        )
    return max(0.0, least)
