"""What a site file says that fixes the world's frame."""

import numpy as np

from elbowroom.calibrate.extrinsics.anchor import (
    Anchor,
    BoardAnchor,
    BoardCorner,
    CameraAnchor,
    KnownPoint,
    PointsAnchor,
    SeenPoint,
)
from elbowroom.errors import CalibrationError
from elbowroom.site import Site
from elbowroom.site.calibration_entry import (
    BoardEntry,
    NamedPoint,
    WorldFromBoard,
    WorldFromCamera,
    WorldFromPoints,
)


def anchor_of(site: Site) -> Anchor:
    """The anchor of a site's key `calibration.world`.

    Raises:
        CalibrationError: nothing is said, or the machine, which `elbowroom calibrate machine` is for.
    """
    entry = site.entry.calibration
    world = None if entry is None else entry.world
    if entry is None or world is None:
        raise CalibrationError(
            f"{site.path}: calibration.world: missing; say by what the world's frame is fixed: board, points, or camera"
        )
    if isinstance(world, WorldFromBoard):
        return BoardAnchor(world.pose, world.world_from_board)
    if isinstance(world, WorldFromCamera):
        return CameraAnchor(world.camera)
    if isinstance(world, WorldFromPoints):
        return PointsAnchor(tuple(_known(point, entry.board) for point in world.points), world.sigma_m)
    raise CalibrationError(
        f"{site.path}: calibration.world: by the machine; fix it by board, points or camera first, then run "
        "`elbowroom calibrate machine`, which finds where its base is"
    )


def _known(point: NamedPoint, board: BoardEntry | None) -> KnownPoint:
    world_m = np.array(point.world_m)
    if point.corner is None or board is None:
        return SeenPoint(
            point.name, world_m, {camera: np.array(pixel) for camera, pixel in point.seen_px.items()}
        )
    on_board = board.square_m * np.array([point.corner.column, point.corner.row, 0.0])
    return BoardCorner(point.name, world_m, point.corner.pose, on_board)
