"""Naive twin of rectification: for each pinhole pixel, look at every raw pixel."""

import numpy as np

from elbowroom.geometry.lens import distorted


def contributors(intrinsics, width, height, u, v, samples=25):
    """The raw pixels, as (row, column), that densely sampled points of pinhole pixel (u, v) fall into."""
    steps = np.linspace(-0.5, 0.5, samples)
    x = (u + steps[:, None] - intrinsics.cx) / intrinsics.fx
    y = (v + steps[None, :] - intrinsics.cy) / intrinsics.fy
    raw_u, raw_v = distorted(intrinsics, *np.broadcast_arrays(x, y))
    columns = np.floor(raw_u + 0.5).astype(int).ravel()
    rows = np.floor(raw_v + 0.5).astype(int).ravel()
    return set(zip(rows.tolist(), columns.tolist(), strict=True))


def bounds(raw, index_map, shallowest, deepest):
    """Twin of the kernel: least and greatest of each rectangle, 0 unless all of it is valid."""
    least, greatest = np.zeros_like(raw), np.zeros_like(raw)
    for v in range(raw.shape[0]):
        for u in range(raw.shape[1]):
            first_u, last_u, first_v, last_v = (int(edge[v, u]) for edge in index_map)
            if first_u < 0:
                continue
            patch = raw[first_v : last_v + 1, first_u : last_u + 1]
            valid = np.isfinite(patch) & (patch > 0) & (patch >= shallowest) & (patch <= deepest)
            if valid.all():
                least[v, u], greatest[v, u] = patch.min(), patch.max()
    return least, greatest
