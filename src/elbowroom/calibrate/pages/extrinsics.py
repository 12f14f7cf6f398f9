"""The page of `elbowroom calibrate extrinsics`: residuals, reprojection, coverage, the graph, what is weak."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.seen_board import SeenBoard
from elbowroom.calibrate.extrinsics.solve import Extrinsics
from elbowroom.calibrate.pages.board_report import (
    ImageOf,
    Reprojected,
    camera_pictures,
    histograms,
    rms,
    what_next,
)
from elbowroom.calibrate.pages.pictures import camera_graph
from elbowroom.calibrate.result.change import change_table
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.lens import project
from elbowroom.view.report.blocks import Block, Picture, Table, Words

Array = NDArray[np.float64]


def report_sections(
    found: Extrinsics, rows: Sequence[Mapping[str, Any]], troubles: Sequence[str], image_of: ImageOf
) -> list[tuple[str, list[Block]]]:
    """Titles and blocks of the page.

    Args:
        found: what was found.
        rows: of kind "camera", as `change_rows` makes them.
        troubles: images that gave no view of the board, a sentence each.
        image_of: images to draw on.
    """
    by_camera: dict[str, list[SeenBoard]] = {one.camera.name: [] for one in found.cameras}
    for one in found.seen:
        by_camera[one.view.camera].append(one)
    overview: list[Block] = [
        Words(
            f"{len(found.cameras)} cameras saw the board in {len(found.world_from_board)} poses, {len(found.seen)} "
            "views in all. How sure a pose is stands as one sigma; margins hold at the confidence that was asked for, "
            "with the site's own sensor margins in them."
        ),
        change_table(rows),
        what_next([note for camera in found.cameras for note in camera.notes]),
    ]
    if found.points_off_m:
        overview.append(_points(found))
    sections = [
        ("What was found", overview),
        ("Cameras and poses from above", [_graph(found), _shared(found)]),
        ("Residuals", [_residuals(found, by_camera), *_histograms(found)]),
    ]
    sections += [("Camera by camera", _cameras(found, by_camera, image_of))]
    if troubles:
        lines = [(text,) for text in troubles]
        sections.append(("Images without a usable view", [Table("", ("what was wrong",), lines)]))
    return sections


def _points(found: Extrinsics) -> Block:
    return Table(
        "Points of known place, which fix the world",
        ("point", "from where it was measured to where it is seen [mm]"),
        [(name, f"{off_m * 1e3:.1f}") for name, off_m in found.points_off_m.items()],
    )


def _graph(found: Extrinsics) -> Block:
    at = {one.camera.name: one.camera.centre_in_world for one in found.cameras}
    boards = [board[:3, 3] for board in found.world_from_board.values()]
    weak = [one.camera.name for one in found.cameras if one.notes]
    return Picture(
        camera_graph(at, boards, found.shared, weak),
        "Cameras (orange: weak, see above), first corner of the board in each pose (blue), lines between cameras that "
        "saw the board at the same time: the wider the more often",
        760,
    )


def _shared(found: Extrinsics) -> Block:
    names = [one.camera.name for one in found.cameras]
    totals = {name: sum(count for pair, count in found.shared.items() if name in pair) for name in names}
    partners = {name: sum(1 for pair in found.shared if name in pair) for name in names}
    views = {name: sum(1 for one in found.seen if one.view.camera == name) for name in names}
    return Table(
        "How well each camera hangs together with the others",
        ("camera", "poses seen", "cameras it shares poses with", "shared poses in all"),
        [(name, str(views[name]), str(partners[name]), str(totals[name])) for name in names],
    )


def _residuals(found: Extrinsics, by_camera: Mapping[str, Sequence[SeenBoard]]) -> Block:
    lines = []
    for one in found.cameras:
        name, px, m = one.camera.name, one.residuals_px, one.residuals_m
        lines.append(
            (
                name,
                str(len(px)),
                f"{rms(px):.3f}",
                f"{px.max():.2f}",
                str(len(m)),
                f"{rms(m) * 1e3:.2f}" if len(m) else "-",
                f"{np.median(m) * 1e3:+.2f}" if len(m) else "-",
                f"{found.depth_bias_m[name] * 1e3:+.1f}" if name in found.depth_bias_m else "-",
                f"{found.depth_scale[name] * 100:+.2f}" if name in found.depth_scale else "-",
                f"{found.corner_factor[name]:.2f}",
                f"{found.plane_factor[name]:.2f}" if name in found.depth_bias_m else "-",
            )
        )
    return Table(
        "Residuals per camera. Depth reads by so much too far: bias and scale. Factors: variance of whole views over "
        "that which their sigmas promise",
        (
            "camera",
            "corners",
            "rms [px]",
            "worst [px]",
            "depth points",
            "rms [mm]",
            "median [mm]",
            "bias [mm]",
            "scale [%]",
            "factor of corners",
            "of depth",
        ),
        lines,
    )


def _histograms(found: Extrinsics) -> list[Block]:
    return histograms(
        np.concatenate([one.residuals_px for one in found.cameras]),
        np.concatenate([one.residuals_m for one in found.cameras]),
    )


def _cameras(
    found: Extrinsics, by_camera: Mapping[str, Sequence[SeenBoard]], image_of: ImageOf
) -> list[Block]:
    blocks: list[Block] = []
    for one in found.cameras:
        views = [
            Reprojected(view.view.pose, view.view.corners_px, _projected(view, found))
            for view in by_camera[one.camera.name]
        ]
        blocks += camera_pictures(one.camera, one.notes, views, image_of)
    return blocks


def _projected(one: SeenBoard, found: Extrinsics) -> Array:
    camera = next(c.camera for c in found.cameras if c.camera.name == one.view.camera)
    pose = invert_rigid(camera.world_from_camera) @ found.world_from_board[one.view.pose]
    return project(camera.intrinsics, one.corners @ pose[:3, :3].T + pose[:3, 3])[0]
