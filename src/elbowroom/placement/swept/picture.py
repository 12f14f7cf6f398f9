"""The space that motions sweep as a picture: from above and from the side, dark where nobody sees it."""

from pathlib import Path

import numpy as np
from PIL import Image

from elbowroom.files.atomic import folder
from elbowroom.geometry import DepthCamera
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import INVALID, VALID, legend, save, title
from elbowroom.placement.swept.unseen import Swept
from elbowroom.view.draw.outline import cut_lines
from elbowroom.view.draw.palette import CAMERA_INK, INK, PAPER
from elbowroom.view.draw.plot import Plot

VIEWS = {"z": (0, 1, 2), "y": (0, 2, 1)}
"""By the axis that is looked along: the axes across and up, and that axis."""


def save_swept(
    found: Swept, cameras: tuple[DepthCamera, ...], room: FixedRoom | None, out_dir: Path | str, name: str
) -> list[Path]:
    """Writes swept_z.png, from above, and swept_y.png, from the side; returns their paths.

    Args:
        found: what is swept, and what of it nobody sees.
        cameras: drawn where they hang.
        room: drawn where the middle of the picture cuts it; None: not drawn.
        out_dir: folder to write into; made if it is not there.
        name: of the room.

    Raises:
        InputError: the folder cannot be written to.
    """
    out_dir = folder(out_dir)
    return [
        save(swept_picture(found, cameras, room, along, name), out_dir / f"swept_{along}.png")
        for along in VIEWS
    ]


def swept_picture(
    found: Swept, cameras: tuple[DepthCamera, ...], room: FixedRoom | None, along: str, name: str
) -> Image.Image:
    """All that is swept, looked at along an axis; the more of a column nobody sees, the more it is coloured so.

    Args:
        found, cameras, room: as of `save_swept`.
        along: "z" from above, "y" from the side.
        name: of the room.
    """
    across, up, normal = VIEWS[along]
    swept, unseen = found.swept.sum(axis=normal), found.unseen.sum(axis=normal)
    share = (unseen / np.maximum(swept, 1))[..., None]
    colours = np.asarray(np.array(VALID) + (np.array(INVALID) - np.array(VALID)) * share).round()
    # a column of which hardly anything is unseen is still told from one that is all seen
    colours = np.where((unseen > 0)[..., None], np.minimum(colours, (245, 200, 160)), colours)
    cells = np.where((swept > 0)[..., None], colours, np.array(PAPER[:3])).astype(np.uint8)
    plane = [across, up]
    plot = Plot.of_cells(cells, found.grid.lower_m[plane], found.grid.voxel_size_m)
    if room is not None:
        middle = float((found.grid.lower_m + found.grid.upper_m)[normal] / 2)
        plot.draw_segments(cut_lines(room.triangles, normal, middle)[:, :, plane], INK, 2)
    for camera in cameras:
        plot.draw_wedge(camera.centre_in_world[plane], camera.world_from_camera[plane, 2], CAMERA_INK)
    plot.draw_axes("xyz"[across], "xyz"[up])
    title(
        plot,
        f"{name}: what the motions sweep, along {along}",
        f"{found.unseen_pct:.1f} % of it nobody sees; {found.poses} poses, {len(cameras)} cameras",
    )
    legend(plot, {"all of it is seen": VALID, "none of it is": INVALID, "not swept": PAPER}, {})
    return plot.picture
