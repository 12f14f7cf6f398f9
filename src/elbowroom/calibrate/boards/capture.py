"""A capture of a board on disk: the images of each pose, and what is seen of the board in them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Pictures

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.closer_look import Looks, closer_look
from elbowroom.calibrate.boards.colour import carried_to_depth
from elbowroom.calibrate.boards.cut_out import cut_out_view
from elbowroom.calibrate.boards.printed import printed_view
from elbowroom.calibrate.boards.same_images import require_own_images
from elbowroom.calibrate.boards.trouble import Trouble
from elbowroom.errors import CalibrationError, FrameError
from elbowroom.geometry import DepthCamera, Intrinsics, nearest_rigid
from elbowroom.geometry.parallel import spread
from elbowroom.site import Site
from elbowroom.site.calibration_entry import CaptureImagesEntry
from elbowroom.site.paths import existing_folder, inside
from elbowroom.site.recording_entry import BagRecording, StampedFolder
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.layouts.layout import layout_of

GOOD_SHARE = 0.4
"""Of the images of a camera that show the board, where the board is as described and the camera in order."""
Seen = BoardView | Trouble


@dataclass(frozen=True, slots=True)
class Sightings:
    """What a capture shows.

    Args:
        board: that was looked for.
        views: what was seen of it.
        troubles: images that gave no view, and why.
        poses: how many poses there are.
    """

    board: Board
    views: tuple[BoardView, ...]
    troubles: tuple[Trouble, ...]
    poses: int

    def is_seen_by(self, cameras: Sequence[str]) -> bool:
        """Whether most of some cameras see the board in a good share of their images, as they do if it is right."""
        good = 0
        for name in cameras:
            views = sum(view.camera == name for view in self.views)
            images = views + sum(trouble.camera == name for trouble in self.troubles)
            good += views >= max(2, GOOD_SHARE * images)
        return good > len(cameras) / 2

    def share_seen_by(self, cameras: Sequence[str]) -> float:
        """In how much of their images some cameras see the board."""
        views = sum(view.camera in cameras for view in self.views)
        return views / max(views + sum(trouble.camera in cameras for trouble in self.troubles), 1)

    def row(self) -> dict[str, Any]:
        """How much was seen, and what was wrong with the rest."""
        return {
            "poses": self.poses,
            "views": len(self.views),
            "troubles": [str(trouble) for trouble in self.troubles],
        }


def board_of(site: Site) -> Board:
    """The board that a site describes.

    Raises:
        CalibrationError: it describes none.
    """
    entry = site.entry.calibration
    if entry is None or entry.board is None:
        raise CalibrationError(
            f"{site.path}: calibration.board: missing; say columns, rows, square_m and kind of the board"
        )
    board = entry.board
    return Board(
        board.columns,
        board.rows,
        board.square_m,
        board.kind,
        board.border_m,
        board.is_marked,
        board.thickness_m,
    )


def images_by_pose(site: Site) -> list[list[Image]]:
    """The depth images of each pose of the board, unread, by time; every camera may lack some.

    Frames within the recording's `max_skew_ms` are of one pose; frames without times are by order.

    Raises:
        SiteError: no recording, or not laid out as the site says.
    """
    by_camera = layout_of(site).by_camera()
    recording = site.entry.recording
    if not isinstance(recording, StampedFolder | BagRecording):
        return [list(group) for group in zip(*by_camera.values(), strict=True)]
    skew_ns = round(recording.max_skew_ms * 1e6)
    poses: list[list[Image]] = []
    begun = None
    for image in sorted((i for row in by_camera.values() for i in row), key=lambda i: i.stamp_ns or 0):
        stamp = image.stamp_ns or 0
        if begun is None or stamp - begun > skew_ns:
            poses.append([])
            begun = stamp
        poses[-1].append(image)
    return poses


def sightings(site: Site, on_image: Callable[[int, int], None] = lambda done, of: None) -> Sightings:
    """Looks for the board in all images.

    Args:
        site: with a board and a recording.
        on_image: is told how many images of how many are done.

    Raises:
        CalibrationError: no board, no images, or the board is not seen at all.
        PackageError: OpenCV is not installed.
        FrameError: an image is not what its camera delivers.
    """
    board, poses = board_of(site), images_by_pose(site)
    work = [(image, number) for number, images in enumerate(poses) for image in images]
    if not work:
        raise CalibrationError(f"{site.path}: recording: no images; make a capture first")
    done: list[int] = []

    def one(item: tuple[Image, int]) -> Seen:
        seen = seen_in(site, board, *item)
        done.append(1)
        on_image(len(done), len(work))
        return seen

    found = spread(one, work)
    views = tuple(seen for seen in found if isinstance(seen, BoardView))
    troubles = tuple(seen for seen in found if isinstance(seen, Trouble))
    if not views:
        what = instead_of(site, board, work) or _commonest(troubles)
        raise CalibrationError(f"{site.path}: {len(work)} images and none shows the board; {what}")
    require_own_images(_pictures(site, work), views)
    return Sightings(board, views, troubles, len(poses))


def _pictures(site: Site, work: Sequence[tuple[Image, int]]) -> list[tuple[Image, int]]:
    """The files in which the board was looked for, instead of depth images, where these are others."""
    entry = site.entry.calibration
    if entry is None or entry.images.folder is None:
        return list(work)
    return [
        (image._replace(path=picture_path(site, entry.images, image, pose)), pose) for image, pose in work
    ]


def images_of(site: Site, cameras: Sequence[str]) -> list[tuple[Image, int]]:
    """The depth images of some cameras, each with the number of its pose.

    Args:
        site: with a recording.
        cameras: their names.
    """
    return [
        (image, number)
        for number, images in enumerate(images_by_pose(site))
        for image in images
        if image.camera.name in cameras
    ]


def instead_of(
    site: Site,
    board: Board,
    work: Sequence[tuple[Image, int]],
    *,
    others_see_it: bool = False,
    seen_share: float = 0.0,
) -> str | None:
    """What images show where they do not show the board, a sentence; None: nothing that can be told.

    Args:
        site: whose images they are.
        board: as the site describes it.
        work: images, and the number of their pose.
        others_see_it: whether other cameras see the board as it is described.
        seen_share: in so much of all images of these cameras it is seen so.
    """
    if not work:
        return None

    def plain(other: Board, image: Image, pose: int) -> Seen:
        return seen_in(site, other, image, pose)

    def mirrored(other: Board, image: Image, pose: int) -> Seen:
        return seen_in(site, other, image, pose, mirrored=True)

    def other_sizes(other: Board, image: Image, pose: int) -> Seen:
        return seen_in(site, other, image, pose, other_sizes=True)

    looks = Looks(plain, mirrored, other_sizes)
    return closer_look(board, work, looks, others_see_it=others_see_it, seen_share=seen_share)


def _commonest(troubles: tuple[Trouble, ...]) -> str:
    """The fault that most images have, with an example of it."""
    counts = [trouble.fault for trouble in troubles]
    fault = max(set(counts), key=counts.count)
    example = next(trouble for trouble in troubles if trouble.fault is fault)
    return f"most often: {fault.value}, such as {example}"


def seen_in(
    site: Site, board: Board, image: Image, pose: int, *, other_sizes: bool = False, mirrored: bool = False
) -> Seen:
    """What one image shows of the board.

    Args:
        site: whose key `calibration` says in which images to look.
        board: the board.
        image: the depth image, unread; infrared and colour images are named like it.
        pose: number of the board's pose.
        other_sizes: as of `cut_out_view`.
        mirrored: whether the image is turned left to right first, to see whether it was mirrored.
    """
    entry = site.entry.calibration
    frame = image.read()
    turn = slice(None, None, -1 if mirrored else 1)
    if entry is None or entry.images.folder is None:
        depth = frame.depth_m[:, turn]
        return cut_out_view(image.camera, board, depth, pose, image.stamp_ns, other_sizes=other_sizes)
    path = picture_path(site, entry.images, image, pose)
    lens = entry.images.lenses.get(image.camera.name)
    if lens is None:
        grey = np.ascontiguousarray(read_grey(path, image.camera)[:, turn])
        infrared = frame.depth_m[:, turn] if entry.images.kind == "infrared" else None
        return printed_view(image.camera, board, grey, infrared, pose, image.stamp_ns)
    k = Intrinsics(lens.fx, lens.fy, lens.cx, lens.cy, lens.distortion)
    colour = DepthCamera(image.camera.name, lens.width, lens.height, np.eye(4), k)
    grey = np.ascontiguousarray(read_grey(path, colour)[:, turn])
    seen = printed_view(colour, board, grey, None, pose, image.stamp_ns)
    if isinstance(seen, Trouble):
        return seen
    where = nearest_rigid(
        lens.colour_from_depth, f"camera {colour.name}: colour_from_depth", CalibrationError
    )
    return carried_to_depth(seen, colour, where, board, image.camera, frame.depth_m)


def picture_path(site: Site, images: CaptureImagesEntry, image: Image, pose: int) -> Path:
    """The infrared or colour picture that belongs to a depth image.

    Args:
        site: of the capture.
        images: which pictures there are, and where.
        image: the depth image.
        pose: its number, from 0.

    Raises:
        SiteError: the folder is not there.
        CalibrationError: fewer pictures are listed than there are depth images.
    """
    folder = existing_folder(images.folder or "", site.path.parent)
    listed = images.files.get(image.camera.name)
    if listed is None:
        return folder / image.camera.name / image.path.name
    if pose >= len(listed):
        raise CalibrationError(
            f"{site.path}: calibration.images.files: {len(listed)} pictures of camera {image.camera.name}, "
            f"but it has a depth image of pose {pose}"
        )
    return folder / inside(folder, listed[pose])


def read_grey(path: Path, camera: DepthCamera) -> NDArray[np.uint8]:
    """An infrared or colour image as grey values of 8 bits, shape (h, w).

    Raises:
        FrameError: missing, damaged, or of another size than the camera's.
    """
    if not path.is_file():
        raise FrameError(f"{path}: no such file; each depth image needs a picture of the same name")
    try:
        with Pictures.open(path, formats=("PNG", "JPEG")) as picture:
            if picture.size != (camera.width, camera.height):
                raise FrameError(
                    f"{path}: {picture.width} x {picture.height} pixels, "
                    f"its camera has {camera.width} x {camera.height}"
                )
            if picture.mode.startswith("I"):
                deep = np.asarray(picture).astype(float)
                return np.asarray(255 * deep / max(deep.max(), 1.0), dtype=np.uint8)
            return np.asarray(picture.convert("L"))
    except (OSError, SyntaxError, ValueError) as error:
        if isinstance(error, FrameError):
            raise
        raise FrameError(f"{path}: truncated or damaged picture ({error}); record or copy it again") from None
