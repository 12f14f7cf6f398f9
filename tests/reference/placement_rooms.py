"""Rooms of boxes and cameras at places, to try placements in."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.site.room_entry import RoomEntry

WALLS = {"lower_m": [-2.5, -2.5, 0.0], "upper_m": [2.5, 2.5, 2.9]}


def room_of(furniture=(), walls=WALLS):
    """A room of walls and boxes, each as (lower, upper)."""
    boxes = [{"name": f"box {n}", "lower_m": low, "upper_m": high} for n, (low, high) in enumerate(furniture)]
    entry = {"furniture": boxes} | ({"walls": walls} if walls else {})
    return FixedRoom.of_entry(RoomEntry.model_validate(entry), Path())


def camera_at(name, eye, target, *, width=64, height=48, fov_deg=90.0, **settings):
    """A pinhole camera that looks from one point to another."""
    focal = width / 2 / np.tan(np.radians(fov_deg) / 2)
    intrinsics = Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2)
    eye, target = (tuple(float(v) for v in p) for p in (eye, target))
    return DepthCamera(name, width, height, looking_at(eye, target), intrinsics, **settings)


def turned(camera, angle_rad):
    """The camera with the whole room turned about z."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    return replace(camera, world_from_camera=turn @ camera.world_from_camera)
