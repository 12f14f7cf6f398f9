"""What the pages of intrinsics and extrinsics share: what to capture next, and each camera's corners in pictures."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.pages.pictures import coverage, histogram, reprojection
from elbowroom.geometry import DepthCamera
from elbowroom.view.report.blocks import Block, Picture, Table, Words

Array = NDArray[np.float64]
ImageOf = Callable[[str, int], NDArray[np.uint8] | None]
"""The grey image of a camera at a pose, shape (h, w); None: there is none to show."""


class Reprojected(NamedTuple):
    """A view of the board: its pose, corners as they were seen and as they are projected, shape (n, 2) [px]."""

    pose: int
    seen_px: Array
    projected_px: Array


def what_next(notes: Sequence[str]) -> Block:
    """What is weak, and what to capture."""
    if not notes:
        return Words("Nothing is weak: no need to capture more.")
    return Table("What to capture next", ("what is weak, and what helps",), [(note,) for note in notes])


def histograms(residuals_px: Array, residuals_m: Array) -> list[Block]:
    """How residuals of corners and of depth are spread."""
    blocks: list[Block] = [Picture(histogram(residuals_px, "px"), "Corners: distance seen to projected", 220)]
    if len(residuals_m):
        blocks.append(Picture(histogram(residuals_m * 1e3, "mm"), "Depth: measured less the board's", 220))
    return blocks


def camera_pictures(
    camera: DepthCamera, notes: Sequence[str], views: Sequence[Reprojected], image_of: ImageOf
) -> list[Block]:
    """Where in the image corners lay, and two views with their corners: the worst, and a middling one.

    Args:
        camera: whose pictures.
        notes: sentences under them.
        views: its views, with their residuals.
        image_of: the grey image of a pose.
    """
    blocks: list[Block] = [
        Words(f"*{camera.name}*: " + (" ".join(f"{note}." for note in notes) or "nothing is weak.")),
        Picture(
            coverage(camera.width, camera.height, [view.seen_px for view in views]),
            f"{camera.name}: corners over all {len(views)} poses",
            200,
        ),
    ]
    off = [rms(np.linalg.norm(view.projected_px - view.seen_px, axis=1)) for view in views]
    shown = {int(np.argmax(off)): "worst", int(np.argsort(off)[len(off) // 2]): "middling"}
    for number, words in sorted(shown.items(), key=lambda item: item[1]):
        view = views[number]
        grey = image_of(camera.name, view.pose)
        if grey is not None:
            blocks.append(
                Picture(
                    reprojection(grey, view.seen_px, view.projected_px),
                    f"{camera.name}, pose {view.pose} ({words}, {off[number]:.2f} px rms): circles where "
                    "corners should be, lines 20 times as long as they are off",
                    480,
                )
            )
    return blocks


def rms(values: Array) -> float:
    """Root mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
