"""When a part of a machine first meets another: steps as long as their distance allows (conservative advancement).

Samples of one in the other's field tell which pairs stay apart; what comes near is looked at exactly (`closing`).
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.machine.kernels.apart import Bodies, relate
from elbowroom.motion.kernels.closing import space, touch
from elbowroom.motion.kernels.field import Fields, at_least
from elbowroom.motion.kernels.mover import Skin, carried, place_at


class Pairs(NamedTuple):
    """Links that must not meet: the samples of one against the field of the other.

    Fields:
        skin: samples of all links in clusters, in these in runs that lie side by side; no triangles.
        width: of the run that begins with each sample, how far its others are from it at most, (samples,) [m].
        fields: of all links.
        sampled, other: rows of the links, (pairs,).
        doubt: by how much more than what is told of it a pair's distance may be, (pairs,) [m].
        pair, cluster: of each cluster of a sampled link, once for each pair, (members,), sorted by pair.
        bodies: the same pairs as triangles.
    """

    skin: Skin
    width: np.ndarray
    fields: Fields
    sampled: np.ndarray
    other: np.ndarray
    doubt: np.ndarray
    pair: np.ndarray
    cluster: np.ndarray
    bodies: Bodies


RUN = 8
"""So many samples of a cluster that lie side by side are passed over together."""


class Now(NamedTuple):
    """How far links are apart where they stand.

    Fields:
        apart: each pair, exact, (pairs,) [m]; infinity: by more than makes a meeting; 0: they lie in each other.
        gaps, least: of `gaps_now`.
    """

    apart: np.ndarray
    gaps: np.ndarray
    least: np.ndarray


class Steps(NamedTuple):
    """How closely meetings are looked for.

    Fields:
        least: links are looked at again after having moved by this, or by their gap if that is more [m].
        together: looks nearer to each other than this share of what is looked at are done at one place.
    """

    least: float
    together: float


@njit
def gap_of(pairs, member, other_from_one, fine_below, nearest):
    """No more than the distance of a cluster's surface from the other link, and the sample that comes nearest.

    Args:
        member: of `pairs`.
        other_from_one: (3, 4).
        fine_below: where the cluster's ball is no nearer than this, it stands for its samples [m].
        nearest: (1,), takes the sample, where samples were looked at.
    """
    skin, cluster, other = pairs.skin, pairs.cluster[member], pairs.other[pairs.pair[member]]
    x, y, z = carried(other_from_one, skin.centre[cluster])
    around = at_least(pairs.fields, other, x, y, z) - skin.radius[cluster] - skin.cover
    if around > fine_below:
        return around
    least = math.inf
    for first in range(skin.start[cluster], skin.stop[cluster], RUN):
        stop = min(first + RUN, skin.stop[cluster])
        for sample in range(first, stop):
            x, y, z = carried(other_from_one, skin.points[sample])
            away = at_least(pairs.fields, other, x, y, z)
            if away < least:
                least = away
                nearest[0] = sample
            # the others of a run are no nearer than its first less its width
            if sample == first and away - pairs.width[first] > least:
                break
    return least - skin.cover


@njit(cache=True, nogil=True)
def gaps_now(pairs, placed, gaps, least):
    """Fills, for each member of the pairs, its gap, and for each pair the least of them [m].

    Args:
        pairs: what must not meet.
        placed: where links are, (links, 4, 4).
        gaps: (members,); those within the pair's doubt are as good as samples and fields are.
        least: (pairs,).
    """
    other_from_one, nearest, last = np.empty((3, 4)), np.zeros(1, dtype=np.int64), -1
    least[:] = math.inf
    for member in range(gaps.size):
        pair = pairs.pair[member]
        if pair != last:
            relate(placed, pairs.sampled[pair], pairs.other[pair], other_from_one)
            last = pair
        gaps[member] = gap_of(pairs, member, other_from_one, pairs.doubt[pair], nearest)
        least[pair] = min(least[pair], gaps[member])


@njit(cache=True, nogil=True)
def first_meeting(mover, parts, pairs, length, now, steps):
    """The travel up to which no pair meets, the pair that meets after it or -1, and where.

    A pair that is apart is looked at exactly (`closing.touch`) from where samples cannot tell any more that it is. One
    that lies in each other has met when it is told to be nearer by all of the doubt: links that stay as deep as they
    are do not meet.

    Args:
        mover: what moves, and how. Its speeds are the most by which the distance of each member's surface from the
            other link changes per unit of travel, (members,) [m]; 0: they move as one.
        parts: the same for all parts of the links (`Travelling`).
        pairs: what must not meet.
        length: travel that is looked at, at most the course's.
        now: how far apart they are (`Now`).
        steps: how closely they are looked for.

    Returns:
        Travel at which the pair that meets was last looked at before, the pair or -1, place (3,) [m].
    """
    tree, speeds, gaps, apart = mover.tree, mover.speeds, now.gaps, now.apart
    place, nearest = np.zeros(3), np.zeros(1, dtype=np.int64)
    placed, other_from_one = np.empty((1, tree.parent.size, 4, 4)), np.empty((3, 4))
    work, found = space(tree.parent.size), -1
    floors = np.where(apart > 0.0, 0.0, np.minimum(now.least - pairs.doubt, 0.0))
    settled = np.zeros(apart.size, dtype=np.bool_)
    # of the members that can meet: which, when to look again, and when they were looked at and had not met
    active, until, before = np.empty(gaps.size, dtype=np.int64), np.empty(gaps.size), np.zeros(gaps.size)
    count = 0
    for member in range(gaps.size):
        pair = pairs.pair[member]
        reach = gaps[member] - floors[pair]
        if speeds[member] <= 0.0 or reach >= speeds[member] * length:
            continue
        if apart[pair] > 0.0 and reach <= 0.0:
            if not settled[pair]:
                settled[pair] = True
                met = min(pairs.bodies.met, apart[pair] / 2)
                end = touch(parts, pairs.bodies, pair, met, (0.0, length), work, place)
                if end >= 0.0:
                    found, length = pair, end
            continue
        active[count], until[count] = member, max(reach, steps.least) / speeds[member]
        count += 1
    while count > 0:
        travel = until[:count].min()
        if travel >= length:
            break
        place_at(mover, travel, placed)
        last, left = -1, 0
        for n in range(count):
            member, safe, known = active[n], until[n], before[n]
            pair = pairs.pair[member]
            if settled[pair]:
                continue
            if safe <= travel + steps.together * length:
                if pair != last:
                    relate(placed[0], pairs.sampled[pair], pairs.other[pair], other_from_one)
                    last = pair
                away = gap_of(pairs, member, other_from_one, floors[pair], nearest) - floors[pair]
                if away <= 0.0:
                    settled[pair], end = True, known
                    if apart[pair] > 0.0:
                        end = touch(parts, pairs.bodies, pair, pairs.bodies.met, (known, length), work, place)
                    else:
                        row = pairs.sampled[pair]
                        place[0], place[1], place[2] = carried(placed[0, row], pairs.skin.points[nearest[0]])
                    if end >= 0.0:
                        found, length = pair, end
                    continue
                safe, known = travel + max(away, steps.least) / speeds[member], travel
            # what stays apart on all of the way is not asked again
            if safe < length:
                active[left], until[left], before[left] = member, safe, known
                left += 1
        count = left
    return length, found, place
