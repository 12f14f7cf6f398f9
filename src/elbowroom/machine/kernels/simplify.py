"""Triangles made fewer: corners are taken out one by one, and how far the surface moves by it is kept count of."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted

MOST_RING = 24
"""A corner of more triangles stays."""
LEAST_QUALITY = 1e-3
"""Twice the area of a triangle over the square of its longest side, at least, for a new one."""
SHAPE_WEIGHT = 0.02
"""How much a well shaped triangle counts against a small error, when both would do."""
ROUNDING = 1e-6
"""A limit is kept with so much of it to spare."""


class Surface(NamedTuple):
    """Triangles, and how far each may have moved.

    Fields:
        points: corners, shape (n, 3) [m].
        faces: indices of corners, shape (m, 3), int64; -1 in the first column: no longer there.
        error: shape (m,) [m]: each point of a face lies within it of the surface as it was, and each point as it was
            within that of some face.
    """

    points: np.ndarray
    faces: np.ndarray
    error: np.ndarray


class Fans(NamedTuple):
    """The faces about each corner: corner v has around[first[v] : first[v + 1]]."""

    first: np.ndarray
    around: np.ndarray


class Marks(NamedTuple):
    """Of each corner whether the faces about it were changed since `Fans` were listed, and the limit up to which it is
    known to stay [m]."""

    changed: np.ndarray
    stays: np.ndarray


class Star(NamedTuple):
    """The faces about one corner, in order.

    Fields:
        faces: their numbers, shape (MOST_RING,).
        ring: the corners about it, anticlockwise seen from outside.
        ends: shape (MOST_RING, 2), each face's other two corners.
        flat: shape (MOST_RING, 3), the ring laid in a plane about the corner: x, y, height over it [m].
    """

    faces: np.ndarray
    ring: np.ndarray
    ends: np.ndarray
    flat: np.ndarray


class Fan(NamedTuple):
    """A way to close the hole that a corner leaves: from which place of the ring, and by how much the surface moves."""

    place: int
    error: float


@njit(cache=True, nogil=True)
def thin(surface, fans, marks, limit):
    """Takes out corners whose hole can be closed without any face's error going beyond a limit; says how many.

    No two of them share a face; the next round takes others. A corner goes only where the faces about it form one ring
    and, seen along the ring's normal, lie side by side without a fold. The hole is closed by triangles from one of the
    ring's corners that lie side by side as well. So points of the old and the new faces that lie over each other pair
    up one to one, the ring stays where it is, and closed surfaces stay closed.

    Args:
        surface: changed.
        fans: of `list_fans`.
        marks: changed; none `changed` before.
        limit: [m].
    """
    star = Star(
        np.empty(MOST_RING, dtype=np.int64),
        np.empty(MOST_RING, dtype=np.int64),
        np.empty((MOST_RING, 2), dtype=np.int64),
        np.empty((MOST_RING, 3)),
    )
    removed = 0
    for v in range(surface.points.shape[0]):
        if marks.changed[v] or marks.stays[v] >= limit or fans.first[v + 1] == fans.first[v]:
            continue
        k = _order(surface.faces, fans, v, star)
        if k == 0 or not _lay_flat(surface.points, v, star, k):
            marks.stays[v] = np.inf
            continue
        before = 0.0
        for n in range(k):
            before = max(before, surface.error[star.faces[n]])
        fan = _best_fan(star, k, marks, limit * (1.0 - ROUNDING) - before)
        if fan.place >= 0 and not _pinches(surface.faces, fans, star, k, fan.place):
            _close(surface, star, k, fan, before + fan.error)
            marks.changed[v] = True
            for n in range(k):
                marks.changed[star.ring[n]], marks.stays[star.ring[n]] = True, 0.0
            removed += 1
        elif not _any_changed(star, k, marks):
            marks.stays[v] = limit
    return removed


@njit(cache=True, nogil=True)
def list_fans(faces, fans):
    """Lists the faces about each corner; `fans` has the sizes (corners + 1,) and (3 * faces,)."""
    first, around = fans.first, fans.around
    first[:] = 0
    for f in range(faces.shape[0]):
        for c in range(3):
            first[faces[f, c] + 1] += 1
    for v in range(first.size - 1):
        first[v + 1] += first[v]
    at = first[:-1].copy()
    for f in range(faces.shape[0]):
        for c in range(3):
            around[at[faces[f, c]]] = f
            at[faces[f, c]] += 1


@uncounted()
def _order(faces, fans, v, star):
    """Puts the faces about a corner in order; returns their number, 0 if they are not one closed ring."""
    k = fans.first[v + 1] - fans.first[v]
    if k < 3 or k > MOST_RING:
        return 0
    ends = star.ends
    for n in range(k):
        f = fans.around[fans.first[v] + n]
        star.faces[n] = f
        c = 0 if faces[f, 0] == v else 1 if faces[f, 1] == v else 2
        ends[n, 0], ends[n, 1] = faces[f, (c + 1) % 3], faces[f, (c + 2) % 3]
    for n in range(k - 1):
        star.ring[n], here = ends[n, 0], ends[n, 1]
        # closed too early
        if here == star.ring[0]:
            return 0
        follows = n + 1
        while follows < k and ends[follows, 0] != here and ends[follows, 1] != here:
            follows += 1
        if follows == k:
            return 0
        # faces may turn either way
        other = ends[follows, 1] if ends[follows, 0] == here else ends[follows, 0]
        ends[follows, 0], ends[follows, 1] = ends[n + 1, 0], ends[n + 1, 1]
        ends[n + 1, 0], ends[n + 1, 1] = here, other
    star.ring[k - 1] = ends[k - 1, 0]
    return k if ends[k - 1, 1] == star.ring[0] else 0


@uncounted()
def _lay_flat(points, v, star, k):
    """Lays a ring in the plane across its own normal; whether the faces about its corner lie side by side there."""
    ox, oy, oz = points[v, 0], points[v, 1], points[v, 2]
    nx, ny, nz = 0.0, 0.0, 0.0
    for i in range(k):
        a, b = star.ring[i], star.ring[(i + 1) % k]
        ax, ay, az = points[a, 0] - ox, points[a, 1] - oy, points[a, 2] - oz
        bx, by, bz = points[b, 0] - ox, points[b, 1] - oy, points[b, 2] - oz
        nx, ny, nz = nx + ay * bz - az * by, ny + az * bx - ax * bz, nz + ax * by - ay * bx
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if not length > 0.0:
        return False
    nx, ny, nz = nx / length, ny / length, nz / length
    # any direction across the normal
    ex, ey, ez = (0.0, nz, -ny) if abs(nx) < 0.6 else (-nz, 0.0, nx)
    length = math.sqrt(ex * ex + ey * ey + ez * ez)
    ex, ey, ez = ex / length, ey / length, ez / length
    fx, fy, fz = ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex
    flat = star.flat
    for i in range(k):
        a = star.ring[i]
        x, y, z = points[a, 0] - ox, points[a, 1] - oy, points[a, 2] - oz
        flat[i, 0] = x * ex + y * ey + z * ez
        flat[i, 1] = x * fx + y * fy + z * fz
        flat[i, 2] = x * nx + y * ny + z * nz
    turns = 0
    for i in range(k):
        j = (i + 1) % k
        x, y, u, w = flat[i, 0], flat[i, 1], flat[j, 0], flat[j, 1]
        if not _across(x, y, u, w) > 1e-6 * max(x * x + y * y, u * u + w * w):
            return False
        turns += y < 0.0 and w >= 0.0
    return turns == 1


@njit(inline="always")
def _across(ax, ay, bx, by):
    """Twice the area of the triangle between two vectors, above 0 if the second lies to the left."""
    return ax * by - ay * bx


@uncounted()
def _best_fan(star, k, marks, budget):
    """The fan that moves the surface least, with some regard to its triangles' shape; place -1: none within budget."""
    best, error, least = -1, 0.0, np.inf
    if not budget > 0.0:
        return Fan(best, error)
    for place in range(k):
        # about a changed corner it is not known which edges there are
        if marks.changed[star.ring[place]]:
            continue
        quality = _quality(star.flat, k, place)
        if quality < LEAST_QUALITY:
            continue
        moved = _moved(star.flat, k, place, budget)
        score = moved + SHAPE_WEIGHT * budget * (1.0 - quality)
        if moved <= budget and score < least:
            best, error, least = place, moved, score
    return Fan(best, error)


@uncounted()
def _quality(flat, k, place):
    """The worst triangle's of a fan; below 0 where they do not lie side by side."""
    worst, ux, uy = 1.0, flat[place, 0], flat[place, 1]
    for n in range(1, k - 1):
        a, b = (place + n) % k, (place + n + 1) % k
        ax, ay, bx, by = flat[a, 0] - ux, flat[a, 1] - uy, flat[b, 0] - ux, flat[b, 1] - uy
        cx, cy = bx - ax, by - ay
        longest = max(ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy)
        worst = min(worst, _across(ax, ay, bx, by) / longest)
        if worst < LEAST_QUALITY:
            break
    return worst


@uncounted()
def _moved(flat, k, place, most):
    """How far a fan's triangles lie over or under those about the corner, anywhere; above `most`: or more.

    Both are flat between their edges, so it is greatest where edges of the one cross edges of the other, or at the
    corner itself.
    """
    ux, uy, uh = flat[place, 0], flat[place, 1], flat[place, 2]
    found = 0.0
    for n in range(1, k - 1):
        a, b = (place + n) % k, (place + n + 1) % k
        ax, ay, bx, by = flat[a, 0] - ux, flat[a, 1] - uy, flat[b, 0] - ux, flat[b, 1] - uy
        to_b, to_a = _across(ax, ay, -ux, -uy), _across(-ux, -uy, bx, by)
        # the corner lies in this triangle
        if to_a >= 0.0 and to_b >= 0.0:
            rise = to_a * (flat[a, 2] - uh) + to_b * (flat[b, 2] - uh)
            found = max(found, abs(uh + rise / _across(ax, ay, bx, by)))
    for n in range(2, k - 1):
        if found > most:
            return found
        a = (place + n) % k
        found = max(found, _moved_along(flat, k, place, a))
    return found


@uncounted()
def _moved_along(flat, k, place, to):
    """The same where one edge of the fan, between two places of the ring, crosses edges from the corner to the ring."""
    ux, uy, uh = flat[place, 0], flat[place, 1], flat[place, 2]
    dx, dy, dh = flat[to, 0] - ux, flat[to, 1] - uy, flat[to, 2] - uh
    found = 0.0
    for m in range(k):
        if m in (to, place):
            continue
        x, y = flat[m, 0], flat[m, 1]
        area = _across(x, y, dx, dy)
        if area == 0.0:
            continue
        along, out = _across(ux, uy, x, y) / area, _across(ux, uy, dx, dy) / area
        if -1e-9 <= along <= 1.0 + 1e-9 and -1e-9 <= out <= 1.0 + 1e-9:
            found = max(found, abs(out * flat[m, 2] - (uh + along * dh)))
    return found


@uncounted()
def _pinches(faces, fans, star, k, place):
    """Whether a new edge of a fan is there already: then the surface would meet itself along it."""
    u = star.ring[place]
    for n in range(2, k - 1):
        w = star.ring[(place + n) % k]
        for m in range(fans.first[u], fans.first[u + 1]):
            f = fans.around[m]
            if faces[f, 0] == w or faces[f, 1] == w or faces[f, 2] == w:
                return True
    return False


@uncounted()
def _close(surface, star, k, fan, error):
    """Puts a fan in place of the faces about a corner; two of them are left over."""
    faces = surface.faces
    for n in range(k):
        f = star.faces[n]
        if n < k - 2:
            faces[f, 0] = star.ring[fan.place]
            faces[f, 1] = star.ring[(fan.place + n + 1) % k]
            faces[f, 2] = star.ring[(fan.place + n + 2) % k]
            surface.error[f] = error
        else:
            faces[f, 0] = -1


@uncounted()
def _any_changed(star, k, marks):
    """Whether a corner of the ring was changed in this round: then the next one may find more."""
    changed = False
    for n in range(k):
        changed |= marks.changed[star.ring[n]]
    return changed
