"""A subject from a viewpoint, as a picture."""

from pathlib import Path

import numpy as np
from PIL import Image

from elbowroom.errors import InputError
from elbowroom.files.atomic import whole_file
from elbowroom.view.picture.layer import Subject
from elbowroom.view.picture.light import SMOOTH, cast
from elbowroom.view.picture.overlay import draw_lines, draw_words, with_frame
from elbowroom.view.picture.viewpoint import Viewpoint

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP"}


def picture_of(subject: Subject, view: Viewpoint, smooth: int = SMOOTH) -> Image.Image:
    """Draws a subject; title and legend come above and below, so that the picture is higher than the view.

    Args:
        subject: what is shown.
        view: from where.
        smooth: rays per side of a pixel.
    """
    light = cast(subject.layers, view, smooth)
    shown = Image.fromarray((255 * np.clip(light.rgb, 0, 1) ** (1 / 2.2)).round().astype(np.uint8))
    shown = draw_lines(shown, subject.lines, view, light.depth_m)
    draw_words(shown, subject.words, view)
    return with_frame(shown, subject, view)


def format_of(path: Path) -> str:
    """The format that a picture's name asks for.

    Raises:
        InputError: none that is known.
    """
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        raise InputError(f"{path}: no kind of picture; name a file that ends in {', '.join(FORMATS)}")
    return found


def save_picture(picture: Image.Image, path: Path) -> Path:
    """Writes a picture; a file of that name is replaced.

    Args:
        picture: RGB.
        path: ends in one of `FORMATS`.

    Raises:
        InputError: another ending, or a folder that cannot be written to.
    """
    kind = format_of(path)
    with whole_file(path) as unfinished:
        picture.save(unfinished, format=kind, optimize=True, quality=92)
    return path
