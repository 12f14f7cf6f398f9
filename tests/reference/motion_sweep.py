"""The swept check as plain as can be: every interval, sample and blocked voxel, one after another."""

import numpy as np


def box_cuts_triangle(triangle, centre, half):
    """Whether a triangle meets a closed cube: cut it by the six planes and see whether anything is left."""
    polygon = [np.asarray(corner, dtype=float) - centre for corner in triangle]
    for axis in range(3):
        for sign in (1.0, -1.0):
            kept = []
            for here, after in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                a, b = half - sign * here[axis], half - sign * after[axis]
                if a >= 0:
                    kept.append(here)
                if (a > 0 > b) or (a < 0 < b):
                    kept.append(here + (after - here) * a / (a - b))
            polygon = kept
            if not polygon:
                return False
    return True


def ball_meets(blocked, grid, centre, radius):
    """Whether a ball meets a blocked voxel of a bool volume, or leaves the grid."""
    if (centre - radius < grid.lower_m).any() or (centre + radius > grid.upper_m).any():
        return True
    low = grid.lower_m + np.argwhere(blocked) * grid.voxel_size_m
    nearest = np.clip(centre, low, low + grid.voxel_size_m)
    return bool((np.linalg.norm(nearest - centre, axis=1) <= radius).any())


def positions_at(way, travel):
    """Joint positions, linear between the knots."""
    columns = way.course.positions.T
    return np.array([np.interp(travel, way.course.travel, column) for column in columns])


def speeds_of(machine, skin, placed, way):
    """Bounds on the speed of each cluster's points, joint by joint up the tree."""
    tree, rates, bounds = machine.tree, way.rates, []
    for link, centre, radius in zip(skin.link, skin.centre, skin.radius, strict=True):
        point = placed[link] @ [*centre, 1]
        arm = np.linalg.norm(centre) + radius + skin.cover
        bound, moved, row = 0.0, False, link
        while row >= 0:
            column = tree.column[row]
            rate = 0.0 if column < 0 else rates[column] * abs(tree.multiplier[row])
            slides = tree.kind[row] == 1
            if rate and slides:
                bound += rate
            elif rate and moved:
                bound += rate * arm
            elif rate:
                axis = placed[row][:3, :3] @ tree.axis[row]
                distance = np.linalg.norm(np.cross(point[:3] - placed[row][:3, 3], axis))
                bound += rate * (distance + radius + skin.cover)
            moved |= rate > 0
            arm += np.linalg.norm(tree.parent_from_joint[row][:3, 3])
            if slides:
                knots = way.course.positions[:, column] * tree.multiplier[row] + tree.offset[row]
                arm += np.abs(knots).max()
            row = tree.parent[row]
        bounds.append(bound)
    return np.array(bounds)


def free_travel(machine, skin, speeds, way, blocked, grid, intervals):
    """Start of the first one in which a triangle, grown by its movement, meets a block, or the length."""
    step = way.length / intervals
    centres = grid.centre_of(np.argwhere(blocked)).reshape(-1, 3)
    for index in range(intervals):
        placed = machine.world_from_link_array(positions_at(way, (index + 0.5) * step)[None])[0]
        for sample, cluster in enumerate(skin.cluster_of):
            if speeds[cluster] == 0:
                continue
            world_from_link = placed[skin.link[cluster]]
            grown = speeds[cluster] * step / 2
            centre = world_from_link[:3, :3] @ skin.points[sample] + world_from_link[:3, 3]
            if not ball_meets(blocked, grid, centre, skin.cover + grown):
                continue
            patch = skin.patches[skin.patch_start[sample] : skin.patch_start[sample + 1]]
            for triangle in skin.triangles[patch] @ world_from_link[:3, :3].T + world_from_link[:3, 3]:
                if (triangle - grown < grid.lower_m).any() or (triangle + grown > grid.upper_m).any():
                    return index * step
                near = np.linalg.norm(
                    np.clip(centre, centres - grid.voxel_size_m / 2, centres + grid.voxel_size_m / 2)
                    - centre,
                    axis=1,
                )
                for voxel in centres[near <= skin.cover + grown]:
                    if box_cuts_triangle(triangle, voxel, grid.voxel_size_m / 2 + grown):
                        return index * step
    return way.length
