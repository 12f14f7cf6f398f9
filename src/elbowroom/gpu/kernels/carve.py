"""What all cameras say of 64 voxels: a thread of the GPU asks them one after the other, voxel by voxel."""

from typing import NamedTuple

import numpy as np

from elbowroom.geometry.kernels.bits import Lattice, uncounted
from elbowroom.reconstruct.kernels.aged import still_through
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.look import ask
from elbowroom.reconstruct.kernels.pixel import settle_word
from elbowroom.reconstruct.kernels.place import cube_at, voxels_of
from elbowroom.reconstruct.kernels.planes import (
    NOTHING,
    PLANES,
    THREE,
    Answers,
    make_canonical,
    note_disputed,
    note_through,
)


class Carving(NamedTuple):
    """All of a carve: the words that are asked, (n,) int64; the grid; the cameras; what is asked, and the answers."""

    words: np.ndarray
    lattice: Lattice
    views: Views
    answers: Answers


@uncounted(cache=True)
def carve_word(carving, number, voxel, lanes):
    """Carves 64 voxels, and writes only their word.

    The pixel test alone: what windows settle on the processor it settles as well, in more steps.

    Args:
        carving: all of it.
        number: which of its words.
        voxel, lanes: scratch, (1,): a record of `reconstruct.kernels.cone`, and one of `reconstruct.kernels.box`.
    """
    views, answers, word = carving.views, carving.answers, carving.words[number]
    boxes = voxels_of(cube_at(carving.lattice, word // 64), word % 64)
    for c in range(views.cameras.size):
        camera = views.cameras[c]
        asked = answers.asked[word]
        if not answers.complete:
            asked &= ~answers.planes[THREE, word]
        if not asked:
            break
        if camera.blank:
            # it disputes what it looks at, as its windows have it
            look = ask(camera, views.windows, boxes, answers.fine[word], lanes[0])
            blind = look.unsure & asked
            note_disputed(answers, word, blind, NOTHING, blind)
            continue
        seen, disputed, surface, blind = settle_word(camera, views.texels, asked, boxes, voxel[0])
        note_disputed(answers, word, disputed, surface, blind)
        if camera.aged_m > 0.0:
            seen = still_through(camera, views.texels, seen, boxes, voxel[0])
        note_through(answers, word, seen)
    if not answers.complete:
        make_canonical(answers.planes, word)
    for plane in range(PLANES):
        answers.planes[plane, word] &= answers.asked[word]
