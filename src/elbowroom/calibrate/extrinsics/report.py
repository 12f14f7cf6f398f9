"""The page of `elbowroom calibrate extrinsics`: residuals, reprojection, coverage, the graph, what is weak."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.change import change_table
from elbowroom.calibrate.extrinsics.seen_board import SeenBoard
from elbowroom.calibrate.extrinsics.solve import Extrinsics
from elbowroom.calibrate.lens import project
from elbowroom.calibrate.pictures import camera_graph, coverage, histogram, reprojection
from elbowroom.geometry import invert_rigid
from elbowroom.view.blocks import Block, Picture, Table, Words

Array = NDArray[np.float64]
ImageOf = Callable[[str, int], NDArray[np.uint8] | None]
"""The grey image of a camera at a pose, shape (h, w); None: there is none to show."""


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
        _next(found),
    ]
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


def _next(found: Extrinsics) -> Block:
    notes = [note for camera in found.cameras for note in camera.notes]
    if not notes:
        return Words("Nothing is weak: no need to capture more.")
    return Table("What to capture next", ("what is weak, and what helps",), [(note,) for note in notes])


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
                f"{_rms(px):.3f}",
                f"{px.max():.2f}",
                str(len(m)),
                f"{_rms(m) * 1e3:.2f}" if len(m) else "-",
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
    px = np.concatenate([one.residuals_px for one in found.cameras])
    m = np.concatenate([one.residuals_m for one in found.cameras])
    blocks: list[Block] = [Picture(histogram(px, "px"), "Corners: distance seen to projected", 220)]
    if len(m):
        blocks.append(Picture(histogram(m * 1e3, "mm"), "Depth: measured less the board's", 220))
    return blocks


def _cameras(
    found: Extrinsics, by_camera: Mapping[str, Sequence[SeenBoard]], image_of: ImageOf
) -> list[Block]:
    blocks: list[Block] = []
    for one in found.cameras:
        camera, own = one.camera, by_camera[one.camera.name]
        blocks.append(
            Words(f"*{camera.name}*: " + (" ".join(f"{note}." for note in one.notes) or "nothing is weak."))
        )
        blocks.append(
            Picture(
                coverage(camera.width, camera.height, [view.view.corners_px for view in own]),
                f"{camera.name}: corners over all {len(own)} poses",
                200,
            )
        )
        off = [_rms(_distances(view, found)) for view in own]
        shown = {int(np.argmax(off)): "worst", int(np.argsort(off)[len(off) // 2]): "middling"}
        for number, words in sorted(shown.items(), key=lambda item: item[1]):
            view = own[number]
            grey = image_of(camera.name, view.view.pose)
            if grey is not None:
                blocks.append(
                    Picture(
                        reprojection(grey, view.view.corners_px, _projected(view, found)),
                        f"{camera.name}, pose {view.view.pose} ({words}, {off[number]:.2f} px rms): circles where "
                        "corners should be, lines 20 times as long as they are off",
                        480,
                    )
                )
    return blocks


def _projected(one: SeenBoard, found: Extrinsics) -> Array:
    camera = next(c.camera for c in found.cameras if c.camera.name == one.view.camera)
    pose = invert_rigid(camera.world_from_camera) @ found.world_from_board[one.view.pose]
    return project(camera.intrinsics, one.corners @ pose[:3, :3].T + pose[:3, 3])[0]


def _distances(one: SeenBoard, found: Extrinsics) -> Array:
    return np.asarray(np.linalg.norm(_projected(one, found) - one.view.corners_px, axis=1))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
