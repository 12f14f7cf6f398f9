"""What a site file may say, key by key."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from elbowroom.site.camera_entry import CameraEntry, CameraSettings, MarginEntry
from elbowroom.site.entry import Count, Entry, Matrix, Number, Point, Positive, Text, Whole
from elbowroom.site.recording_entry import RecordingEntry, SevenScenes

Fov = Annotated[Number, Field(gt=10, lt=170)]


class GridEntry(Entry):
    """The watched box: its least corner, its greatest corner or its count of voxels, the edge of a voxel."""

    origin_m: Point
    upper_m: Point | None = None
    shape: tuple[Count, Count, Count] | None = None
    voxel_size_m: Positive

    @model_validator(mode="after")
    def _one_extent(self) -> "GridEntry":
        if (self.upper_m is None) == (self.shape is None):
            raise ValueError("exactly one of upper_m and shape")
        return self


class MachineEntry(Entry):
    """The machine: one that ships with the package, or a URDF; where its base stands; links not to check.

    `explain_tolerance_m` is how far from its model a measured point may lie and still be the machine itself.
    """

    builtin: Literal["ceiling_c_arm"] | None = None
    urdf: Text | None = None
    world_from_base: Matrix | None = None
    unchecked_links: tuple[Text, ...] = ()
    explain_tolerance_m: Positive | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "MachineEntry":
        if (self.builtin is None) == (self.urdf is None):
            raise ValueError("exactly one of builtin and urdf")
        return self


class JointEntry(Entry):
    """Full speed of a joint, in metres or degrees a second, and the time in which it brakes from it."""

    max_speed_m_s: Positive | None = None
    max_speed_deg_s: Positive | None = None
    braking_time_s: Positive

    @model_validator(mode="after")
    def _one_speed(self) -> "JointEntry":
        if (self.max_speed_m_s is None) == (self.max_speed_deg_s is None):
            raise ValueError("exactly one of max_speed_m_s (prismatic) and max_speed_deg_s (revolute)")
        return self


class SimulatedEntry(Entry):
    """The simulated intervention room: cameras along its walls, people who walk, a C-arm that moves."""

    cameras: Annotated[Whole, Field(ge=1, le=200)] = 21
    camera_height_m: Annotated[Number, Field(gt=0, le=2.9)] = 2.4
    resolution: Annotated[Text, Field(pattern=r"^[0-9]{1,5}x[0-9]{1,5}$")] = "640x480"
    field_of_view_deg: Fov = 90.0
    seed: Annotated[Whole, Field(ge=0)] = 1

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of each image [px]."""
        width, height = (int(side) for side in self.resolution.split("x"))
        return width, height


SIMULATED_SETTINGS = ("depth_kind", "noise", "min_depth_m", "max_depth_m")
"""What `camera_defaults` may say of simulated cameras."""


class SiteEntry(Entry):
    """All of a site file."""

    name: Text = "site"
    grid: GridEntry
    camera_defaults: CameraSettings = CameraSettings()
    cameras: tuple[CameraEntry, ...] = ()
    machine: MachineEntry | None = None
    joints: dict[Text, JointEntry] = Field(default_factory=dict)
    rule: Literal["three", "majority", "veto", "any"] = "three"
    detail: Literal["footprint", "pixel", "point"] = "pixel"
    margin: MarginEntry = MarginEntry()
    max_frame_age_ms: Positive | None = None
    recording: RecordingEntry | None = None
    simulated: SimulatedEntry | None = None

    @model_validator(mode="after")
    def _fits_together(self) -> "SiteEntry":
        names = [camera.name for camera in self.cameras]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise ValueError(f"each camera a name of its own; {', '.join(doubled)} is there more than once")
        brings_cameras = self.simulated is not None or isinstance(self.recording, SevenScenes)
        if brings_cameras and self.cameras:
            raise ValueError("no list of cameras where simulated or layout seven_scenes brings its own")
        if not brings_cameras and not self.cameras:
            raise ValueError("at least one camera, or simulated, or a recording of layout seven_scenes")
        if self.simulated is not None and self.recording is not None:
            raise ValueError("either simulated or recording, not both")
        if self.simulated is not None:
            beyond = sorted(self.camera_defaults.model_fields_set - set(SIMULATED_SETTINGS))
            if beyond:
                raise ValueError(
                    f"camera_defaults of a simulated room: {', '.join(SIMULATED_SETTINGS)}; not {beyond[0]}"
                )
        if self.joints and self.machine is None:
            raise ValueError("joints only with a machine")
        return self
