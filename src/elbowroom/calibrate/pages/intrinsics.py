"""The page of `elbowroom calibrate intrinsics`: lenses, residuals, reprojection, coverage, what is weak."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.intrinsics.solve import FoundIntrinsics
from elbowroom.calibrate.pages.board_report import (
    ImageOf,
    Reprojected,
    camera_pictures,
    histograms,
    rms,
    what_next,
)
from elbowroom.geometry.lens import project
from elbowroom.view.report.blocks import Block, Table, Words


def report_sections(
    found: Sequence[FoundIntrinsics],
    corners_in_board: NDArray[np.float64],
    troubles: Sequence[str],
    image_of: ImageOf,
) -> list[tuple[str, list[Block]]]:
    """Titles and blocks of the page.

    Args:
        found: what was found, camera by camera.
        corners_in_board: of the board, shape (n, 3) [m].
        troubles: images that gave no view of the board, a sentence each.
        image_of: images to draw on.
    """
    overview: list[Block] = [
        Words(
            f"Cameras: {len(found)}; views of the board in all: {sum(len(one.views) for one in found)}. Beside each "
            "number stands one sigma. Measured depth = scale x true depth + bias."
        ),
        _lenses(found),
        what_next([note for one in found for note in one.notes]),
    ]
    corners = np.concatenate([np.linalg.norm(one.residuals_px, axis=1) for one in found])
    depths = np.concatenate([one.residuals_m for one in found])
    pictures = [
        block
        for one in found
        for block in camera_pictures(one.camera, one.notes, _views(one, corners_in_board), image_of)
    ]
    sections = [
        ("What was found", overview),
        ("Residuals", [_residuals(found), *histograms(corners, depths)]),
        ("Camera by camera", pictures),
    ]
    if troubles:
        lines = [(text,) for text in troubles]
        sections.append(("Images without a usable view", [Table("", ("what was wrong",), lines)]))
    return sections


def lens_table(found: Sequence[FoundIntrinsics]) -> Table:
    """What was found, a line a camera, as short as a screen needs it."""
    columns = (
        "camera",
        "views",
        "fx",
        "fy",
        "cx",
        "cy",
        "distortion",
        "depth scale",
        "depth bias",
        "corners",
    )
    lines = []
    for one in found:
        k = one.camera.intrinsics
        lines.append(
            (
                one.camera.name,
                str(len(one.views)),
                *(
                    f"{getattr(k, name):.2f} ±{sigma:.2f}"
                    for name, sigma in zip(("fx", "fy", "cx", "cy"), one.sigma[:4], strict=True)
                ),
                str(len(k.distortion)),
                f"{one.depth_scale:.4f} ±{one.depth_sigma[0]:.4f}",
                f"{1e3 * one.depth_bias_m:.1f} ±{1e3 * one.depth_sigma[1]:.1f} mm",
                f"{float(np.sqrt(np.mean(one.residuals_px**2))):.2f} px",
            )
        )
    return Table("Intrinsics: what was found, and one sigma", columns, lines)


def _lenses(found: Sequence[FoundIntrinsics]) -> Block:
    lines = []
    for one in found:
        k, before = one.camera.intrinsics, one.before.intrinsics
        lines.append(
            (
                one.camera.name,
                str(len(one.views)),
                *(
                    f"{getattr(k, name):.2f} ±{sigma:.2f} ({getattr(k, name) - getattr(before, name):+.2f})"
                    for name, sigma in zip(("fx", "fy", "cx", "cy"), one.sigma[:4], strict=True)
                ),
                " ".join(f"{number:+.4f}" for number in k.distortion) or "-",
                f"{one.depth_scale:.4f} ±{one.depth_sigma[0]:.4f}",
                f"{1e3 * one.depth_bias_m:+.1f} ±{1e3 * one.depth_sigma[1]:.1f}",
            )
        )
    columns = (
        "camera",
        "views",
        "fx [px]",
        "fy [px]",
        "cx [px]",
        "cy [px]",
        "distortion",
        "depth scale",
        "depth bias [mm]",
    )
    return Table("Lenses and depth: found, one sigma, in brackets what changed", columns, lines)


def _residuals(found: Sequence[FoundIntrinsics]) -> Block:
    lines = []
    for one in found:
        px, m = np.linalg.norm(one.residuals_px, axis=1), one.residuals_m
        lines.append(
            (
                one.camera.name,
                str(len(px)),
                f"{rms(px):.3f}",
                f"{px.max():.2f}",
                str(len(m)),
                f"{rms(m) * 1e3:.2f}" if len(m) else "-",
                f"{np.median(m) * 1e3:+.2f}" if len(m) else "-",
            )
        )
    columns = ("camera", "corners", "rms [px]", "worst [px]", "depth points", "rms [mm]", "median [mm]")
    return Table("Residuals per camera", columns, lines)


def _views(one: FoundIntrinsics, corners_in_board: NDArray[np.float64]) -> list[Reprojected]:
    """Corners as they were seen, and where what was found puts them."""
    return [
        Reprojected(
            view.pose,
            view.corners_px,
            project(one.camera.intrinsics, corners_in_board[view.corner_ids] @ pose[:3, :3].T + pose[:3, 3])[
                0
            ],
        )
        for view, pose in zip(one.views, one.camera_from_boards, strict=True)
    ]
