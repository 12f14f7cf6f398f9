"""How often a voxel that a sharp or thin solid touches is declared free: what the promise on solids leaves out.

    python benchmarks/thin_solids.py [scenes]

Writes benchmarks/results/thin_solids.json. Each scene is one solid in an otherwise empty room, seen without noise and
without margins: a box of 10 to 40 cm with corners, turned at random, or a rod 60 cm long with round ends. The rod's
diameter is given in pixel pitches at its range, of the camera that sees it most coarsely.
"""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from elbowroom.files.atomic import whole_file
from elbowroom.files.json_rows import meta
from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame
from reference.reconstruct_scenes import camera_at, corners_of, rays_of

RESULT = Path(__file__).resolve().parent / "results" / "thin_solids.json"
GRID = VoxelGrid((-0.6, -0.6, -0.6), (24, 24, 24), 0.05)
SIZE, FOCAL = (160, 120), 110.0
WALL_M = 6.0
GROUPS = ((1, "any"), (6, "three"), (21, "three"))
DIAMETERS_PX = (0.25, 0.5, 1.0, 2.0, 3.0)


class Box:
    """A box with corners, turned."""

    def __init__(self, rng, cameras):
        self.turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        self.half = rng.uniform(0.05, 0.2, 3)
        self.centre = rng.uniform(-0.3, 0.3, 3)

    def enter(self, eye, rays):
        """Planar depth where rays enter it, infinite where they miss."""
        with np.errstate(divide="ignore"):
            away, along = (eye - self.centre) @ self.turn, rays @ self.turn
            one, other = (-self.half - away) / along, (self.half - away) / along
        near, far = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
        return np.where((near <= far) & (near > 0), near, np.inf)

    def touched(self):
        """The voxels that it touches, by separating axes."""
        middle = corners_of(GRID) + GRID.voxel_size_m / 2 - self.centre
        crossed = [np.cross(a, b) for a in np.eye(3) for b in self.turn.T]
        meets = np.ones(GRID.shape, dtype=bool)
        for axis in [*np.eye(3), *self.turn.T, *crossed]:
            reach = np.abs(axis).sum() * GRID.voxel_size_m / 2 + np.abs(axis @ self.turn) @ self.half
            meets &= np.abs(middle @ axis) < reach
        return meets


class Rod:
    """A cylinder with round ends; `px` is its diameter in pixel pitches."""

    LENGTH_M = 0.6

    def __init__(self, rng, cameras, px):
        centre = rng.uniform(-0.2, 0.2, 3)
        along = rng.normal(size=3)
        self.along = along / np.linalg.norm(along)
        self.start = centre - self.along * self.LENGTH_M / 2
        coarsest = max(np.linalg.norm(camera.centre_in_world - centre) for camera in cameras) / FOCAL
        self.radius = px * coarsest / 2

    def enter(self, eye, rays):
        """Planar depth where rays enter it, infinite where they miss."""
        away = eye - self.start
        across_rays = rays - (rays @ self.along)[..., None] * self.along
        across = away - away @ self.along * self.along
        t = _first_root(across_rays, across, self.radius)
        height = away @ self.along + np.where(np.isfinite(t), t, 0) * (rays @ self.along)
        t = np.where((height >= 0) & (height <= self.LENGTH_M), t, np.inf)
        for end in (self.start, self.start + self.LENGTH_M * self.along):
            t = np.minimum(t, _first_root(rays, eye - end, self.radius))
        return t

    def touched(self):
        """The voxels that balls along it touch: at most a hundredth of its radius is left out between them."""
        lower = corners_of(GRID)
        hit = np.zeros(GRID.shape, dtype=bool)
        for place in np.arange(0, self.LENGTH_M, 0.28 * self.radius):
            at = self.start + place * self.along
            first = np.maximum(GRID.index_of(at - self.radius), 0)
            last = GRID.index_of(at + self.radius) + 1
            part = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
            nearest = np.clip(at, lower[part], lower[part] + GRID.voxel_size_m)
            hit[part] |= np.linalg.norm(nearest - at, axis=-1) < self.radius
        return hit


def _first_root(rays, away, radius):
    """The lesser t > 0 with |away + t ray| = radius, infinite where there is none."""
    a, b, c = (rays * rays).sum(axis=-1), rays @ away, away @ away - radius**2
    under = b * b - a * c
    t = (-b - np.sqrt(np.maximum(under, 0))) / a
    return np.where((under >= 0) & (t > 0), t, np.inf)


def cameras_around(rng, count):
    """Cameras 1.8 to 3.2 m from the middle, half of them with radial depth."""
    cameras = []
    for n in range(count):
        away = rng.normal(size=3)
        eye = away / np.linalg.norm(away) * rng.uniform(1.8, 3.2)
        kind = ("planar", "radial")[n % 2]
        cameras.append(
            camera_at(f"c{n}", eye, rng.uniform(-0.1, 0.1, 3), rng.uniform(-3, 3), SIZE, FOCAL, kind)
        )
    return cameras


def frame_of(camera, solid):
    """The exact image of one solid before walls at WALL_M."""
    rays = rays_of(camera)
    depth = np.minimum(solid.enter(camera.centre_in_world, rays), WALL_M)
    if camera.depth_kind == "radial":
        depth = depth * np.linalg.norm(rays, axis=-1)
    return DepthFrame(camera.name, 0, depth.astype(np.float32))


def row_of(name, make, count, rule, scenes):
    """One row for each detail: voxels touched and voxels among them that were declared free."""
    touched_voxels, freed, with_freed = 0, {"footprint": 0, "pixel": 0}, {"footprint": 0, "pixel": 0}
    for seed in range(scenes):
        rng = np.random.default_rng(seed)
        cameras = cameras_around(rng, count)
        solid = make(rng, cameras)
        frames = [frame_of(camera, solid) for camera in cameras]
        touched = solid.touched()
        touched_voxels += int(touched.sum())
        for detail in freed:
            wrong = int((reconstruct(GRID, cameras, frames, rule=rule, detail=detail).free & touched).sum())
            freed[detail] += wrong
            with_freed[detail] += wrong > 0
    return [
        {
            "solid": name,
            "cameras": count,
            "rule": rule,
            "detail": detail,
            "width": SIZE[0],
            "height": SIZE[1],
            "voxel_size_m": GRID.voxel_size_m,
            "scenes": scenes,
            "scenes_with_false_free": with_freed[detail],
            "touched_voxels": touched_voxels,
            "false_free_voxels": freed[detail],
            "occupied_pct": 100 * (1 - freed[detail] / touched_voxels),
        }
        for detail in freed
    ]


def main(scenes=200):
    """Writes all rows."""
    solids = {"box with corners": Box} | {
        f"rod of {px:g} pixel pitches": lambda rng, cameras, px=px: Rod(rng, cameras, px)
        for px in DIAMETERS_PX
    }
    rows = []
    for name, make in solids.items():
        for count, rule in GROUPS:
            rows += row_of(name, make, count, rule, scenes)
            for row in rows[-2:]:
                print(f"{name:28} {count} {rule:6} {row['detail']:10} {row['occupied_pct']:8.4f} %")
    said = meta() | {"command": f"python benchmarks/thin_solids.py {scenes}"}
    with whole_file(RESULT) as unfinished:
        unfinished.write_text(json.dumps({"meta": said, "rows": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:2]))
