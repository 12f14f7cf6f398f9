"""Images that are the same to the bit, which no sensor delivers twice: a frozen stream, a folder copied twice."""

import hashlib
from collections import defaultdict
from collections.abc import Iterable

from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.errors import CalibrationError
from elbowroom.sources.layouts.image import Image

LEAST_FROZEN = 3
"""A camera all of whose images are the same, and so many, was frozen even if none shows the board."""


def require_own_images(work: Iterable[tuple[Image, int]], views: Iterable[BoardView]) -> None:
    """No two images that show the board are the same to the bit, nor all of one camera.

    Of an empty room perfect simulated cameras deliver the same image twice; of a board in a hand they do not.

    Args:
        work: images, and the number of their pose.
        views: what was seen of the board.

    Raises:
        CalibrationError: a camera whose images are the same, or two cameras that share theirs.
    """
    seen = {(view.camera, view.pose) for view in views}
    alike: dict[bytes, list[tuple[str, int]]] = defaultdict(list)
    counts: dict[str, int] = defaultdict(int)
    for image, pose in work:
        counts[image.camera.name] += 1
        alike[hashlib.blake2b(image.content(), digest_size=16).digest()].append((image.camera.name, pose))
    doubled = [
        group
        for group in alike.values()
        if len(group) > 1
        and (any(one in seen for one in group) or len(group) == counts[group[0][0]] >= LEAST_FROZEN)
    ]
    if not doubled:
        return
    worst = max(doubled, key=len)
    cameras = sorted({camera for camera, _ in worst})
    if len(cameras) == 1:
        raise CalibrationError(
            f"camera {cameras[0]}: {len(worst)} of its images are the same to the bit (poses "
            f"{_listed([pose for _, pose in worst])}): its stream was frozen, or a file was copied; capture again, or "
            "leave the camera out"
        )
    shared = [group for group in doubled if {camera for camera, _ in group} >= set(cameras)]
    raise CalibrationError(
        f"cameras {' and '.join(cameras)}: {len(shared)} of their images are the same to the bit: one stream, or one "
        "folder, was taken for both; capture again"
    )


def _listed(poses: list[int]) -> str:
    shown = ", ".join(str(pose) for pose in sorted(poses)[:6])
    return shown + (f" and {len(poses) - 6} more" if len(poses) > 6 else "")
