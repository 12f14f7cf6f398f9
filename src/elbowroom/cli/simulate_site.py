"""A site's own room, cameras and machine, as the simulator takes them, and the site file of what it made."""

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.cli.simulate_mesh import RoomFile
from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.simulate import InterventionRoom, Moment
from elbowroom.simulate.crowd import Floor
from elbowroom.simulate.floor import floor_height
from elbowroom.simulate.rounds import walking_staff
from elbowroom.simulate.scene import Course, InUse, Surroundings, scene_in
from elbowroom.simulate.solid import Solid
from elbowroom.site import Site
from elbowroom.site.paths import expand
from elbowroom.site.recording_entry import SevenScenes, StampedFolder
from elbowroom.site.written import camera_entry, said_again, written
from elbowroom.sources.cameras import cameras_of, with_noise
from elbowroom.sources.recorder import UNIT_M
from elbowroom.sources.recording_folder import Units

BY = "written by elbowroom simulate: images of a modelled room"
UNMOVED = ("watch",)
"""Keys of a site that say nothing of its simulated twin: a reference of the true room is none of it."""


@dataclass(frozen=True, slots=True, eq=False)
class SiteRoom:
    """All that the simulator needs of a site.

    Args:
        site: the file.
        box: the watched box.
        cameras: of the site, with the noise that is asked for.
        machine: of the site; None: there is none.
        solids, surfaces: what never moves; of a simulated room none are named here.
        walls_m: inner faces of the walls, shape (2, 3) [m]; None: not known.
        images: the folder of images.
        noise: instead of the site's; None: the site's.
        mesh: the room's file instead of the site's; None: the site's.
    """

    site: Site
    box: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    machine: Machine | None
    solids: tuple[Solid, ...]
    surfaces: tuple[Solid, ...]
    walls_m: np.ndarray | None
    images: Path
    noise: str | None
    mesh: RoomFile | None

    @property
    def units(self) -> dict[str, Units]:
        """By camera, how its depth is counted on disk: as the site reads it."""
        if self.site.simulated is not None:
            return {camera.name: Units(UNIT_M) for camera in self.cameras}
        return {
            camera.name: Units(self.site.depth_scale_m(camera.name), self.site.depth_bias_m(camera.name))
            for camera in self.cameras
        }

    @property
    def folder_beside_site(self) -> str:
        """The folder of images as the site file would write it."""
        return os.path.relpath(self.images.absolute(), self.site.path.parent.absolute())

    def scene(self, course: Course) -> tuple[InUse, tuple[str, ...]]:
        """The room in use, and what one should know of it.

        Raises:
            MachineError, InputError: as `scene_in`.
        """
        if self.site.simulated is not None:
            room = InterventionRoom(machine=self.machine, staff=walking_staff())
            return Intervention(room, course), ()
        speeds = {}
        if self.machine is not None:
            entries = self.site.entry.joints
            speeds = {name: entries[name].speed_of(self.machine.joint(name)) for name in entries}
        scene = scene_in(self._around(), self.machine, replace(course, speeds=speeds))
        return scene, scene.notes

    def write(self, out: Path | None) -> Path:
        """The site file that reads the images: the site's own where they lie in its recording, else `out`/site.yaml.

        Raises:
            SiteError, InputError: it cannot be written.
        """
        if out is None:
            return self.site.path
        path = out / "site.yaml"
        content = {key: value for key, value in said_again(self.site, path).items() if key not in UNMOVED}
        content["recording"] = {"layout": "folder", "folder": "images"}
        if self.mesh is not None:
            content["room"] = self.mesh.entry(out)
        if self.noise is not None:
            content["camera_defaults"] = {**content.get("camera_defaults", {}), "noise": self.noise}
            for camera in content.get("cameras", ()):
                camera.pop("noise", None)
        return written(self._with_cameras(content), path, BY)

    def _with_cameras(self, content: dict[str, Any]) -> dict[str, Any]:
        """The cameras of a simulated room one by one, since its images come from a folder now."""
        if self.site.simulated is None:
            return content
        content = {
            key: value for key, value in content.items() if key not in ("simulated", "camera_defaults")
        }
        content["camera_defaults"] = {"depth_scale_m": UNIT_M}
        content["cameras"] = [camera_entry(camera) for camera in self.cameras]
        return content

    def _around(self) -> Surroundings:
        box, walls = self.box, self.walls_m
        lower, upper = box.lower_m[:2], box.upper_m[:2]
        if walls is None:
            floor = Floor(lower, upper, floor_height(box, self.solids))
        else:
            lower, upper = np.maximum(lower - 0.5, walls[0, :2]), np.minimum(upper + 0.5, walls[1, :2])
            floor = Floor(lower, upper, float(walls[0, 2]))
        eyes = np.array([camera.centre_in_world for camera in self.cameras])
        return Surroundings(box, self.solids, self.surfaces, floor, eyes)


@dataclass(frozen=True, slots=True, eq=False)
class Intervention:
    """The simulated intervention room as the simulator's other rooms: its own people walk, its C-arm moves.

    Args:
        room: the room.
        course: joints that hold throughout, or none; whether the machine moves.
    """

    room: InterventionRoom
    course: Course

    def at(self, time_s: float) -> Moment:
        """All that is in the room at a time [s]."""
        joints = self.course.joints
        if joints is None and not self.course.moves:
            joints = self.room.at(self.course.times_s[0]).joints
        return self.room.at(time_s, joints=joints)


def site_room(path: Path, room: RoomFile | None, out: Path | None, noise: str | None) -> SiteRoom:
    """A site as the simulator takes it.

    Args:
        path: of the site file.
        room: instead of the site's; None: the site's.
        out: where images go, in `images`; None: to the site's recording.
        noise: instead of the site's, by name; None: the site's.

    Raises:
        SiteError: a site that cannot be used.
        InputError: no room, no place for images, a noise where the site's own recording is written.
    """
    site = Site.load(path)
    if isinstance(site.entry.recording, SevenScenes):
        raise InputError(
            f"{path}: layout seven_scenes makes a camera of each frame; simulate a site that lists cameras"
        )
    images = _images(site, out)
    if noise is not None and out is None:
        raise InputError(f"noise: {path} would not say so; change it there, or give --out DIR")
    cameras = cameras_of(site if noise is None else with_noise(site, noise))
    solids, surfaces, walls = _solids(site, room)
    return SiteRoom(
        site=site,
        box=site.grid(),
        cameras=cameras,
        machine=site.machine(),
        solids=solids,
        surfaces=surfaces,
        walls_m=walls,
        images=images,
        noise=noise,
        mesh=room,
    )


def _images(site: Site, out: Path | None) -> Path:
    if out is not None:
        return out / "images"
    recording = site.entry.recording
    if not isinstance(recording, StampedFolder):
        raise InputError(
            f"out: missing; name a folder, or write into {site.path}: "
            "recording: {layout: folder, folder: recording}"
        )
    if site.simulated is not None:
        raise InputError(f"out: missing; {site.path} reads no recording")
    return expand(recording.folder, site.path.parent)


def _solids(
    site: Site, room: RoomFile | None
) -> tuple[tuple[Solid, ...], tuple[Solid, ...], np.ndarray | None]:
    """Closed solids, surfaces, and the inner faces of the walls if they are known."""
    if site.simulated is not None:
        if room is not None:
            raise InputError(f"room: {site.path} is a simulated room and brings its own; leave it out")
        return (), (), None
    if room is not None:
        return room.solids(site.grid()), (), None
    fixed = FixedRoom.of_site(site)
    if fixed is None:
        raise InputError(
            f"room: missing; give --room my.glb, or describe walls and furniture in {site.path}: "
            "room: {walls: {lower_m: [...], upper_m: [...]}, furniture: [...]}"
        )
    walls = fixed.walls_m if site.entry.room is not None and site.entry.room.walls is not None else None
    return fixed.solids, fixed.surfaces, walls
