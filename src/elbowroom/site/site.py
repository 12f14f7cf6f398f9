"""One file that says all of a room: grid, cameras, machine, speeds, rule, recording."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from elbowroom.choices import Detail, Rule
from elbowroom.errors import CameraError, GridError, InputError, PoseWarning, SiteError
from elbowroom.files.yaml_file import read_yaml
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.together import together
from elbowroom.motion import Braking, Motion, Override
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import Margin
from elbowroom.site import seven_scenes
from elbowroom.site.camera_entry import CameraSettings, build_camera, mended_poses
from elbowroom.site.machine_entry import braking_of, motions_of
from elbowroom.site.messages import one_line
from elbowroom.site.paths import existing_bag, existing_folder, expand
from elbowroom.site.recording_entry import BagRecording, SevenScenes, StamplessFolder
from elbowroom.site.schema import SimulatedEntry, SiteEntry
from elbowroom.site.zone_entry import with_zones

SIMULATED_ROOM = Path(__file__).with_name("simulated_room.yaml")
"""The site file of the simulated intervention room, shipped with the package."""
THESIS_ROOM = Path(__file__).with_name("thesis_room.yaml")
"""The site file of the thesis' room, without cameras: where placements are tried."""
NEW_SITE = Path(__file__).with_name("new_site.yaml")
"""A commented, valid site file to start from."""
DEFAULT_EXPLAIN_TOLERANCE_M = 0.01

Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class Site:
    """All of a room, as a site file says it. Made by `Site.load`.

    What the file names (poses, a machine, images) is read when it is asked for, and then kept.

    Args:
        path: the site file; what it names lies relative to its folder.
        entry: its content, validated.
    """

    path: Path
    entry: SiteEntry

    @classmethod
    def load(cls, path: str | Path) -> "Site":
        """Reads and validates a site file.

        Raises:
            SiteError: missing, no YAML, an unknown key, a value that is not allowed; one line that names
                file, key, what was found and what is allowed.
        """
        path = Path(path)
        try:
            entry = SiteEntry.model_validate(read_yaml(path))
        except ValidationError as error:
            raise one_line(path, SiteEntry, error) from None
        site = cls(path, entry)
        site.grid()
        site.margin()
        return site

    @classmethod
    def simulated_room(cls) -> "Site":
        """The simulated intervention room that ships with the package."""
        return cls.load(SIMULATED_ROOM)

    @property
    def name(self) -> str:
        """Name of the room."""
        return self.entry.name

    @property
    def rule(self) -> Rule:
        """By which rule voxels are declared free."""
        return self.entry.rule

    @property
    def detail(self) -> Detail:
        """How closely voxels are tested."""
        return self.entry.detail

    @property
    def simulated(self) -> SimulatedEntry | None:
        """Settings of the simulated room; None: the cameras are real."""
        return self.entry.simulated

    @property
    def has_stamps(self) -> bool:
        """Whether its frames have times: all but those of recordings that were laid out without."""
        return not isinstance(self.entry.recording, StamplessFolder | SevenScenes)

    @property
    def max_age_ns(self) -> int | None:
        """Age from which a frame counts no more [ns]; None: no limit, or frames without times."""
        limit = self.entry.max_frame_age_ms
        return round(limit * 1e6) if limit is not None and self.has_stamps else None

    @property
    def explain_tolerance_m(self) -> float:
        """How far from the machine's model a measured point may lie and still be the machine [m].

        Of several machines the least: one that says nothing has the usual one.
        """
        alone = () if self.entry.machine is None else (self.entry.machine,)
        said = [machine.explain_tolerance_m for machine in (*alone, *self.entry.machines)]
        return min(
            (DEFAULT_EXPLAIN_TOLERANCE_M if value is None else value for value in said),
            default=DEFAULT_EXPLAIN_TOLERANCE_M,
        )

    def terms(self, rule: Rule | None = None, detail: Detail | None = None) -> Terms:
        """How strictly space is judged here.

        Args:
            rule, detail: others than the file's; None: the file's.
        """
        return Terms(
            rule or self.rule,
            detail or self.detail,
            self.margin(),
            self.max_age_ns,
            self.explain_tolerance_m,
            witness_angle_deg=self.entry.witness_angle_deg,
            people_speed_m_s=self.entry.people_speed_m_s,
            nothing_moves=self.entry.nothing_moves,
            pass_ns=round((self.entry.pass_time_ms or 0.0) * 1e6),
            without_machine=self.entry.recording is not None and self.entry.recording.without_machine,
        )

    def margin(self) -> Margin:
        """The margin of all cameras that have none of their own."""
        return self.entry.margin.build()

    def grid(self, voxel_size_m: float | None = None) -> VoxelGrid:
        """The watched box.

        Args:
            voxel_size_m: another edge of a voxel for the same box [m]; None: the file's.

        Raises:
            SiteError: empty, or more voxels than this computer's memory holds.
        """
        return self._blame(None, lambda: self.entry.grid.build(voxel_size_m))

    def cameras(self) -> tuple[DepthCamera, ...]:
        """All cameras, in the order of the file; for layout `seven_scenes` one per frame that it takes.

        Raises:
            SiteError: a camera that none can be, or a file of it that is not usable; there are none yet; or the
                simulator makes them (`simulated_cameras`).
        """
        return self._cameras_and_notes[0]

    @property
    def mended_poses(self) -> tuple[str, ...]:
        """Which poses were a little off a rotation and were mended; none where the simulator makes the cameras."""
        listed = self.simulated is None or self.lists_cameras
        return self._cameras_and_notes[1] if listed else ()

    @property
    def lists_cameras(self) -> bool:
        """Whether the file lists cameras one by one: a simulated room may, or else the simulator makes them."""
        return bool(self.entry.cameras)

    @cached_property
    def _cameras_and_notes(self) -> tuple[tuple[DepthCamera, ...], tuple[str, ...]]:
        if self.simulated is not None and not self.lists_cameras:
            raise SiteError(f"{self.path}: a simulated room, its cameras are made by the simulator")
        if not self.lists_cameras and not isinstance(self.entry.recording, SevenScenes):
            raise SiteError(
                f"{self.path}: cameras: none yet; `elbowroom placement optimise` finds places for them"
            )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", PoseWarning)
            recording = self.entry.recording
            if isinstance(recording, SevenScenes):
                folder = self.recording_folder()
                cameras = self._seven_scenes_cameras(
                    self._blame("recording", lambda: seven_scenes.chosen(folder, recording))
                )
            else:
                cameras = tuple(self._listed_camera(index) for index in range(len(self.entry.cameras)))
        return cameras, mended_poses([str(warning.message) for warning in caught])

    def _listed_camera(self, index: int) -> DepthCamera:
        given, folder = self.entry.cameras[index], self.path.parent
        settings = given.over(self.entry.camera_defaults)
        return self._blame(
            f"cameras[{index}] ({given.name})",
            lambda: build_camera(given.name, settings, given.pose(folder), folder),
        )

    def _seven_scenes_cameras(self, numbers: tuple[int, ...]) -> tuple[DepthCamera, ...]:
        folder = self.recording_folder()
        defaults = self.entry.camera_defaults
        settings = CameraSettings().over(defaults)
        if defaults.intrinsics_file is None and defaults.fx is None:
            settings["intrinsics_file"] = str((folder / seven_scenes.INTRINSICS_FILE).absolute())
        return tuple(
            self._blame(
                f"frame {number}",
                lambda number=number: build_camera(  # type: ignore[misc]
                    seven_scenes.name_of(number),
                    settings,
                    seven_scenes.pose(folder, number),
                    self.path.parent,
                ),
            )
            for number in numbers
        )

    def excluded_cameras(self) -> tuple[DepthCamera, ...]:
        """For layout `seven_scenes`, a camera for each excluded frame, to check with; otherwise none."""
        recording = self.entry.recording
        if not isinstance(recording, SevenScenes):
            return ()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PoseWarning)
            return self._seven_scenes_cameras(tuple(sorted(recording.exclude)))

    def settings_of(self, camera: str) -> Mapping[str, Any]:
        """What the file says of a camera, with the shared defaults: keys of `CameraSettings`.

        Raises:
            SiteError: there is no camera of this name.
        """
        brought = self.simulated is not None and not self.lists_cameras
        if brought or isinstance(self.entry.recording, SevenScenes):
            return CameraSettings().over(self.entry.camera_defaults)
        for entry in self.entry.cameras:
            if entry.name == camera:
                return entry.over(self.entry.camera_defaults)
        known = ", ".join(entry.name for entry in self.entry.cameras)
        raise SiteError(f"{self.path}: unknown camera {camera!r}; cameras are {known}")

    def depth_scale_m(self, camera: str) -> float:
        """Metres per unit of a camera's 16-bit images."""
        return float(self.settings_of(camera).get("depth_scale_m", CameraSettings().depth_scale_m))

    def depth_bias_m(self, camera: str) -> float:
        """What is added to a camera's depth after its scale [m]: the bias that calibration found, taken out."""
        return float(self.settings_of(camera).get("depth_bias_m", CameraSettings().depth_bias_m))

    def pose_covariance(self, camera: str) -> NDArray[np.float64] | None:
        """What calibration left open of a camera's pose, shape (6, 6); None: the file does not say.

        Rotation vector [rad], then translation [m], camera's frame; the true pose is world_from_camera @ exp(error).

        Raises:
            SiteError: there is no camera of this name.
        """
        given = self.settings_of(camera).get("pose_covariance")
        return None if given is None else np.array(given)

    def sensor_margin(self, camera: str) -> Margin:
        """The part of a camera's margin that is its sensor's own: `sensor_margin`, or else all of its margin.

        Raises:
            SiteError: there is no camera of this name.
        """
        settings = self.settings_of(camera)
        given = settings.get("sensor_margin") or settings.get("margin")
        return self.margin() if given is None else given.build()

    def simulated_cameras(self) -> dict[str, Any]:
        """Arguments for the simulator's `wall_cameras` that make this room's cameras.

        Raises:
            SiteError: the room is not simulated, or its cameras are listed.
        """
        if self.simulated is None:
            raise SiteError(f"{self.path}: not a simulated room; it has no key simulated")
        if self.lists_cameras:
            raise SiteError(f"{self.path}: lists its cameras one by one; the simulator makes none")
        return self.simulated.camera_arguments(self.entry.camera_defaults)

    def machine(self) -> Machine | None:
        """The machine at its place; None if the file names none.

        Raises:
            SiteError, MachineError: a URDF, a link or a pose that is not usable.
        """
        return self._machine

    @cached_property
    def _machine(self) -> Machine | None:
        given, beside = self.entry.machine, self.path.parent
        if given is not None:
            alone = given
            machine = self._blame("machine", lambda: alone.standing(beside))
        elif self.entry.machines:
            members = [
                self._blame(f"machines[{n}] ({entry.name})", lambda entry=entry: entry.member(beside))  # type: ignore[misc]
                for n, entry in enumerate(self.entry.machines)
            ]
            machine = self._blame(None, lambda: self._across(together(members)))
        else:
            return None
        return self._blame(None, lambda: with_zones(machine, self.entry.zones, self.path.parent))

    def _across(self, machine: Machine) -> Machine:
        """Several machines as one, with the pairs of links of all of them that may touch or are not compared."""
        machine = machine.allowing(*self.entry.allowed_contacts)
        if self.entry.own_links is None:
            return machine
        known = OwnLinks.from_yaml(expand(self.entry.own_links, self.path.parent)).among(machine.link_names)
        own = (known,) if machine.own_links is None else (machine.own_links, known)
        return machine.comparing(OwnLinks.all_of(own))

    def motions(self, machine: Machine) -> tuple[Motion, ...]:
        """Each joint that has a speed, in both directions, with its braking distance at full speed.

        Args:
            machine: the machine of this site.

        Raises:
            SiteError: a joint that the machine does not have, or a speed in the unit of another kind of
                joint.
        """
        reaction_s = self.entry.stopping.reaction_time_ms / 1e3
        return self._blame(None, lambda: motions_of(machine, self.entry.joints, reaction_s))

    def braking(self, machine: Machine) -> Braking:
        """How the joints that have a speed come to rest.

        Args:
            machine: the machine of this site.

        Raises:
            SiteError: as `motions`.
        """
        return self._blame(None, lambda: braking_of(machine, self.entry.joints, self.entry.stopping))

    def override(self, machine: Machine) -> Override:
        """How fast an operator who holds on may creep where nobody sees.

        Args:
            machine: the machine of this site.

        Raises:
            SiteError: as `motions`.
        """
        joints = self.entry.joints
        speeds = {name: joints[name].speed_of(machine.joint(name)) for name in joints}
        return self.entry.override.build(speeds)

    def recording_folder(self) -> Path:
        """The folder of the recording; of a bag its folder, or its file.

        Raises:
            SiteError: the site names none, or it is absent.
        """
        recording = self.entry.recording
        if recording is None:
            raise SiteError(
                f"{self.path}: recording: missing; this command reads one (`elbowroom simulate` makes one of a "
                "modelled room)"
            )
        if isinstance(recording, BagRecording):
            return self._blame("recording.file", lambda: existing_bag(recording.file, self.path.parent))
        return self._blame("recording.folder", lambda: existing_folder(recording.folder, self.path.parent))

    @property
    def missing_recording(self) -> str | None:
        """Why the recording that the site names cannot be read yet; None: its folder is there, or none is named.

        Raises:
            SiteError: its path is none.
        """
        if self.entry.recording is None:
            return None
        try:
            self.recording_folder()
        except SiteError as error:
            if "no folder" in str(error):  # of a bag: "no folder or file"
                return str(error).removeprefix(f"{self.path}: ")
            raise
        return None

    def _blame(self, key: str | None, make: Callable[[], Value]) -> Value:
        """What `make` returns; its errors name the file and the key."""
        where = f"{self.path}: {key}" if key else str(self.path)
        try:
            return make()
        except (SiteError, CameraError, GridError) as error:
            raise SiteError(f"{where}: {error}") from None
        except InputError as error:
            raise type(error)(f"{where}: {error}") from None
