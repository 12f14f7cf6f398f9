"""Naive twin of the footprint test: blocks of 4 voxels, then voxels, 64 at a time in plain float32 arrays."""

import numpy as np

from reference.reconstruct_pixel import BLIND, DISPUTES, NEUTRAL, SURFACE, THROUGH
from reference.reconstruct_pyramid import NO_RETURN, window

F = np.float32
LANES = np.stack(np.meshgrid(range(4), range(4), range(4), indexing="ij"), axis=-1).reshape(64, 3)
OUTSIDE, PARTLY, INSIDE, CROSSING = range(4)


class Boxes:
    """The 64 children, of an edge, of the cube whose least corner is given, as one camera sees them."""

    def __init__(self, image, corner, edge):
        self.image = image
        camera, lens = image.camera, image.camera.intrinsics
        rotation = camera.camera_from_world[:3, :3]
        first = rotation @ (corner + edge / 2) + camera.camera_from_world[:3, 3]
        self.half = np.abs(rotation).sum(axis=1) * edge / 2
        scale = np.array([lens.fx, lens.fy, 1.0])
        places = (first * scale).astype(F) + (LANES @ rotation.T * edge * scale).astype(F)
        self.x, self.y, self.z = places.T
        self.ex, self.ey, self.ez = (F(half) * F(s) for half, s in zip(self.half, scale, strict=True))
        self.state_of_all = self._state_of_all(first, rotation, edge)
        if self.state_of_all != OUTSIDE:
            self._place(lens, edge)

    def _state_of_all(self, first, rotation, edge):
        camera, lens = self.image.camera, self.image.camera.intrinsics
        middle, half = first + 1.5 * edge * rotation.sum(axis=1), 4 * self.half
        near, far = middle[2] - half[2], middle[2] + half[2]
        if far <= 0:
            return OUTSIDE
        if near <= 2e-3:
            return PARTLY
        ends = [
            (middle[a] + sign * half[a]) / z * f + o
            for a, f, o in ((0, lens.fx, lens.cx), (1, lens.fy, lens.cy))
            for sign in (-1, 1)
            for z in (near, far)
        ]
        widen = self.image.lateral_px + 0.02
        u0, u1, v0, v1 = (
            min(ends[:4]) - widen,
            max(ends[:4]) + widen,
            min(ends[4:]) - widen,
            max(ends[4:]) + widen,
        )
        if u1 <= -1 or v1 <= -1 or u0 >= camera.width or v0 >= camera.height:
            return OUTSIDE
        whole = u0 >= 0 and v0 >= 0 and u1 <= camera.width - 1 and v1 <= camera.height - 1
        return INSIDE if whole else PARTLY

    def _place(self, lens, edge):
        image, camera = self.image, self.image.camera
        near, far = self.z - self.ez, self.z + self.ez
        last = F(camera.width - 1), F(camera.height - 1)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if self.state_of_all == INSIDE:
                self.state = np.full(64, INSIDE)
                rz, rn = F(1) / self.z, F(1) / near
                self.u = np.floor(self.x * rz + (F(lens.cx) + F(0.5)))
                self.v = np.floor(self.y * rz + (F(lens.cy) + F(0.5)))
                counted = np.ones(64, dtype=bool)
            else:
                rz, rn, counted = self._place_partly(lens, near, far, last)
        # from the middle to the farther side, where the pixel's own place may cost 1.5 pixels more
        aside = np.maximum(
            (np.abs(self.x) + self.ex) * rn - np.abs(self.x) * rz,
            (np.abs(self.y) + self.ey) * rn - np.abs(self.y) * rz,
        )
        widest = int((np.where(counted, np.minimum(aside, F(32768)), F(0)) * F(1024)).max()) / 1024
        self.reach = reach = int(np.ceil(widest + image.lateral_px + 1.5 + 0.02)) - 1
        self.level = image.lowest
        while (2 << self.level) < reach:
            self.level += 1
        if camera.depth_kind == "radial":
            x, y = self.x * F(1 / lens.fx), self.y * F(1 / lens.fy)
            distance = np.sqrt(x * x + y * y + self.z * self.z)
            near, far = distance - F(edge * 0.8660255), distance + F(edge * 0.8660255)
        m = [F(value) for value in image.polynomial]
        beyond = np.maximum(far - m[4], F(0))
        margin = m[0] + far * (m[1] + far * m[2]) + m[3] * beyond * beyond + np.abs(far) * F(2e-6)
        self.near, self.far = near - margin, far + margin

    def _place_partly(self, lens, near, far, last):
        ahead = near > F(1e-3)
        lateral = F(self.image.lateral_px) + F(0.01)
        rn, rf, rz = (F(1) / np.where(ahead, depth, F(1)) for depth in (near, far, self.z))
        spans, centres = [], []
        axes = ((self.x, self.ex, F(lens.cx)), (self.y, self.ey, F(lens.cy)))
        for (at, half, offset), end in zip(axes, last, strict=True):
            low, high = at - half, at + half
            first = np.minimum(low * rn, low * rf) + offset - lateral
            final = np.maximum(high * rn, high * rf) + offset + lateral
            spans.append((np.floor(np.clip(first, -1, end + 1)), np.ceil(np.clip(final, -1, end + 1))))
            middle = np.clip(np.floor(at * rz + (offset + F(0.5))), 0, end)
            centres.append(np.where(ahead, middle, F(0)))
        (u0, u1), (v0, v1) = spans
        visible = (u1 >= 0) & (u0 <= last[0]) & (v1 >= 0) & (v0 <= last[1])
        whole = (u0 >= 0) & (u1 <= last[0]) & (v0 >= 0) & (v1 <= last[1])
        ahead_state = np.where(visible, np.where(whole, INSIDE, PARTLY), OUTSIDE)
        self.state = np.where(ahead, ahead_state, np.where(far <= 0, OUTSIDE, CROSSING))
        self.u, self.v = centres
        return rz, rn, visible & ahead

    def looked_up(self, bounds):
        """Least and greatest depth [m] in each lane's window."""
        least, greatest = np.zeros(64, dtype=F), np.zeros(64, dtype=F)
        for lane in range(64):
            low, high = window(*bounds, self.level, int(self.u[lane]), int(self.v[lane]))
            least[lane] = F(low) * F(self.image.quantum)
            greatest[lane] = F(high) * F(self.image.quantum) if high < NO_RETURN else np.inf
        return least, greatest

    def measured(self):
        """Least and greatest depth [m] that unexplained pixels measured about each lane's centre pixel.

        In whole tiles of 4 x 4.
        """
        image, camera = self.image, self.image.camera
        least, greatest = np.zeros(64, dtype=F), np.zeros(64, dtype=F)
        for lane in range(64):
            span = []
            for middle, size in ((int(self.v[lane]), camera.height), (int(self.u[lane]), camera.width)):
                first, last = max(middle - self.reach, 0), min(middle + self.reach, size - 1)
                span.append(slice(first // 4 * 4, last // 4 * 4 + 4))
            low, high = (bound[tuple(span)] for bound in image.doubt)
            least[lane] = F(low.min()) * F(image.quantum)
            greatest[lane] = F(high.max()) * F(image.quantum) if high.max() < NO_RETURN else np.inf
        return least, greatest

    def decided(self):
        """Lanes (through, unsure, cut): seen through; mixed; all seen through but not all in the image."""
        if self.state_of_all == OUTSIDE:
            return np.zeros((3, 64), dtype=bool)
        least, greatest = self.looked_up(self.image.trust)
        past, hidden = least > self.far, greatest < self.near
        unsure = (self.state == CROSSING) | ((self.state != OUTSIDE) & ~hidden & ~past)
        return (self.state == INSIDE) & past, unsure, (self.state == PARTLY) & past

    def says(self):
        """What the camera says of each voxel."""
        through, unsure, _ = self.decided()
        says = np.where(through, THROUGH, 0)
        if not unsure.any():
            return says
        if self.image.blank:
            return says + np.where(unsure, DISPUTES | BLIND, 0)
        greatest = self.looked_up(self.image.trust)[1]
        lowest, highest = self.measured()
        settled = (lowest > self.far) | (highest < self.near)
        for lane in np.flatnonzero(unsure):
            crossing = self.state[lane] == CROSSING
            crossing = self.state[lane] == CROSSING
            if crossing or not (self.image.split and settled[lane]):
                says[lane] |= DISPUTES
            if crossing:
                continue
            says[lane] |= BLIND if np.isinf(greatest[lane]) else 0
            here = tuple(int(bound[int(self.v[lane]), int(self.u[lane])]) for bound in self.image.doubt)
            measured = here[1] * self.image.quantum
            if here != NEUTRAL and here[1] != NO_RETURN and self.near[lane] <= measured <= self.far[lane]:
                says[lane] |= SURFACE
        return says


def says_of(grid, images):
    """What each camera says of each voxel by the footprint test, shape (cameras, *grid.shape)."""
    padded = np.zeros((len(images), *(-(-n // 16) * 16 for n in grid.shape)), dtype=int)
    edge = grid.voxel_size_m
    for n, image in enumerate(images):
        for cube in np.ndindex(*(-(-n // 16) for n in grid.shape)):
            first = np.array(cube) * 16
            through, unsure, cut = Boxes(image, grid.lower_m + first * edge, 4 * edge).decided()
            for lane, block in enumerate(LANES):
                at = first + 4 * block
                place = (n, *(slice(start, start + 4) for start in at))
                if through[lane]:
                    padded[place] = THROUGH
                elif unsure[lane] or cut[lane]:
                    padded[place] = Boxes(image, grid.lower_m + at * edge, edge).says().reshape(4, 4, 4)
    return padded[:, : grid.shape[0], : grid.shape[1], : grid.shape[2]]
