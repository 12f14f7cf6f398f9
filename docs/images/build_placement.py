"""Draws the pictures of docs/placement.md: python docs/images/build_placement.py (two to three minutes)."""

from dataclasses import replace
from pathlib import Path

from PIL import Image

from elbowroom.geometry import VoxelGrid
from elbowroom.placement import (
    FixedRoom,
    Goal,
    Search,
    candidates_of,
    capability,
    even_cameras,
    known_sensors,
    optimise,
    sweep,
    verify,
)
from elbowroom.placement.charts import capability_section, curve
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.pictures import plan, section
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.site import Site
from elbowroom.site.room_entry import RoomEntry
from elbowroom.site.site import THESIS_ROOM

HERE = Path(__file__).resolve().parent
AIM_M = 0.4
AT_EDGE = {"walls": {"lower_m": [-2.0, -2.0, 0.0], "upper_m": [2.0, 2.0, 2.9]}}


def main() -> None:
    """The thesis' room with 21 cameras along the walls, the curve of its Fig. 4, and an optimised layout."""
    site = Site.load(THESIS_ROOM)
    room, grid = FixedRoom.of_site(site), site.grid()
    assert room is not None and room.walls_m is not None
    even = verify(grid, even_cameras(room.walls_m, known_sensors()["vga"], 21, aim_m=AIM_M), room)
    keep("placement_even.png", plan(even, room, "21 along the walls"))
    keep("placement_views.png", section(even, room, 2, 0, by_count=True))
    at_edge = FixedRoom.of_entry(RoomEntry.model_validate(AT_EDGE), HERE)
    curves = {
        f"walls {side} m": sweep(site.grid(0.1), walls, known_sensors()["vga"], range(3, 41))
        for side, walls in ((5, room), (4, at_edge))
    }
    keep("placement_sweep.png", curve(curves, 3))
    done = optimise(grid, room, candidates_of(site, grid, room), goal=Goal(98.9), search=Search(40.0))
    keep("placement_optimised.png", plan(done.found, room, "Optimised"))
    small = [replace(camera, noise=NOISE_PRESETS["tof"]) for camera in done.cameras]
    small = [with_joined_pixels(camera, 160) for camera in small]
    layer = VoxelGrid.covering((-2.0, -2.0, 1.0), (2.0, 2.0, 1.2), 0.02)
    keep(
        "placement_capability.png", capability_section(capability(verify(layer, small, room), 3), room, 2, 5)
    )


def keep(name: str, picture: Image.Image) -> None:
    """Writes a picture of few colours, small enough for a page."""
    small = picture.resize((picture.width * 3 // 4, picture.height * 3 // 4), Image.Resampling.LANCZOS)
    small.convert("P", palette=Image.Palette.ADAPTIVE, colors=250).save(HERE / name, optimize=True)
    print(name, (HERE / name).stat().st_size)


if __name__ == "__main__":
    main()
