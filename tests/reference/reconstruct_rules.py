"""Naive twin of planes, merging and deciding: what each camera says of each voxel, counted with sets."""

import numpy as np

from reference.reconstruct_pixel import BLIND, DISPUTES, SURFACE, THROUGH


def planes_by_counting(says, complete):
    """Planes (6, ...) bool from each camera's sum of says, shape (cameras, ...)."""
    planes = np.zeros((6, *says.shape[1:]), dtype=bool)
    for voxel in np.ndindex(says.shape[1:]):
        here = [int(say[voxel]) for say in says]
        through = sum(bool(say & THROUGH) for say in here)
        planes[(slice(0, 3), *voxel)] = [through >= n for n in (1, 2, 3)]
        disputed, measured, blind = (any(say & kind for say in here) for kind in (DISPUTES, SURFACE, BLIND))
        if complete:
            planes[(slice(3, 6), *voxel)] = disputed, measured, blind
        elif through < 3:
            planes[(slice(3, 6), *voxel)] = disputed, measured, blind and not measured
    return planes


def free_by_rule(says, rule):
    """Which voxels are free, shape of a plane."""
    free = np.zeros(says.shape[1:], dtype=bool)
    for voxel in np.ndindex(free.shape):
        here = [int(say[voxel]) for say in says]
        through = {n for n, say in enumerate(here) if say & THROUGH}
        disputing = {n for n, say in enumerate(here) if say & DISPUTES}
        measured = {n for n, say in enumerate(here) if say & SURFACE}
        free[voxel] = {
            "three": len(through) >= 3 or (bool(through) and not disputing),
            "majority": len(through) > len(disputing),
            "veto": bool(through) and not measured,
            "any": bool(through),
        }[rule]
    return free
