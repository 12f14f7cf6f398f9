"""What a site file may say, key by key."""

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from elbowroom.choices import Detail, Rule
from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct.terms import MOST_ANGLE_DEG, PEOPLE_SPEED_M_S, WITNESS_ANGLE_DEG, require_speed
from elbowroom.site.black_box_entry import BlackBoxEntry
from elbowroom.site.calibration_entry import CalibrationEntry
from elbowroom.site.camera_entry import CameraEntry, CameraSettings, MarginEntry
from elbowroom.site.entry import Count, Entry, Flag, NotNegative, Number, Point, Positive, Text, Whole
from elbowroom.site.gate_entry import GateEntry
from elbowroom.site.health_entry import HealthEntry
from elbowroom.site.machine_entry import JointEntry, MachineEntry, MemberEntry, OverrideEntry, StoppingEntry
from elbowroom.site.memory import physical_memory_bytes, require_memory
from elbowroom.site.placement_entry import PlacementEntry
from elbowroom.site.ranges import CENTIMETRES, MILLIMETRES, SECONDS, between, speed_of_people, up_to
from elbowroom.site.recording_entry import RecordingEntry, SevenScenes
from elbowroom.site.room_entry import RoomEntry
from elbowroom.site.separation_entry import SeparationEntry
from elbowroom.site.watch_entry import WatchEntry
from elbowroom.site.zone_entry import ZoneEntry

LARGEST_ROOM_M = 500.0
Fov = Annotated[Number, Field(gt=10, lt=170)]


class GridEntry(Entry):
    """The watched box: its least corner, its greatest corner or its count of voxels, the edge of a voxel."""

    origin_m: Point
    upper_m: Point | None = None
    shape: tuple[Count, Count, Count] | None = None
    voxel_size_m: Annotated[Positive, Field(ge=1e-4), up_to(1, "m", MILLIMETRES, CENTIMETRES, usual=0.01)]

    @model_validator(mode="after")
    def _one_extent(self) -> "GridEntry":
        if (self.upper_m is None) == (self.shape is None):
            raise ValueError("exactly one of upper_m and shape")
        shape = self.shape or (0, 0, 0)
        upper = self.upper_m or [
            low + n * self.voxel_size_m for low, n in zip(self.origin_m, shape, strict=True)
        ]
        span = max(high - low for low, high in zip(self.origin_m, upper, strict=True))
        if span > LARGEST_ROOM_M:
            raise ValueError(
                f"a box of at most {LARGEST_ROOM_M:g} m; this one is {span:g} m long: most likely it is in millimetres"
            )
        return self

    def build(self, voxel_size_m: float | None = None) -> VoxelGrid:
        """The grid.

        Args:
            voxel_size_m: another edge of a voxel for the same box [m]; None: the file's.

        Raises:
            GridError: empty, or more voxels than this computer's memory holds.
        """
        if self.shape is not None:
            grid = VoxelGrid(self.origin_m, self.shape, self.voxel_size_m)
        else:
            grid = VoxelGrid.covering(self.origin_m, self.upper_m or (), self.voxel_size_m)
        if voxel_size_m is not None:
            grid = VoxelGrid.covering(grid.lower_m, self.upper_m or grid.upper_m, voxel_size_m)
        require_memory(grid, physical_memory_bytes())
        return grid


class SimulatedEntry(Entry):
    """The simulated intervention room: cameras along its walls, people who walk, a C-arm that moves."""

    cameras: Annotated[Whole, Field(ge=1, le=200)] = 21
    camera_height_m: Annotated[
        tuple[Annotated[Number, Field(gt=0, le=2.9)], ...],
        BeforeValidator(lambda given: given if isinstance(given, list | tuple) else [given]),
        Field(min_length=1),
    ] = (2.4, 0.4)
    resolution: Annotated[Text, Field(pattern=r"^[0-9]{1,5}x[0-9]{1,5}$")] = "640x480"
    field_of_view_deg: Fov = 90.0
    seed: Annotated[Whole, Field(ge=0)] = 1

    def camera_arguments(self, shared: CameraSettings) -> dict[str, Any]:
        """Arguments for the simulator's `wall_cameras`.

        Args:
            shared: the site's `camera_defaults`.
        """
        from elbowroom.simulate.cameras import (
            Optics,  # the simulator is slow to load, and most sites need none
        )

        width, height = (int(side) for side in self.resolution.split("x"))
        return {
            "count": self.cameras,
            "height_m": self.camera_height_m,
            "width": width,
            "height": height,
            "optics": Optics(
                self.field_of_view_deg,
                shared.depth_kind,
                shared.min_depth_m,
                math.inf if shared.max_depth_m is None else shared.max_depth_m,
            ),
            "noise": None if shared.noise is None else shared.noise.build(),
        }


EVEN_SETTINGS = ("cameras", "camera_height_m", "resolution", "field_of_view_deg")
"""What `simulated` says of the cameras that it makes, unless the site lists its own."""
SIMULATED_SETTINGS = ("depth_kind", "noise", "min_depth_m", "max_depth_m", "repeats")
"""What `camera_defaults` may say of simulated cameras."""


class SiteEntry(Entry):
    """All of a site file.

    Beside `machines`, `allowed_contacts` and `own_links` name links of all of them, as `left/tool`.
    """

    name: Text = "site"
    grid: GridEntry
    camera_defaults: CameraSettings = CameraSettings()
    cameras: tuple[CameraEntry, ...] = ()
    machine: MachineEntry | None = None
    machines: tuple[MemberEntry, ...] = ()
    allowed_contacts: tuple[tuple[Text, Text], ...] = ()
    own_links: Text | None = None
    joints: dict[Text, JointEntry] = Field(default_factory=dict)
    zones: tuple[ZoneEntry, ...] = ()
    override: OverrideEntry = OverrideEntry()
    stopping: StoppingEntry = StoppingEntry()
    rule: Rule = "three"
    detail: Detail = "pixel"
    witness_angle_deg: Annotated[Number, Field(ge=0, le=MOST_ANGLE_DEG)] = WITNESS_ANGLE_DEG
    margin: MarginEntry = MarginEntry()
    max_frame_age_ms: Annotated[Positive, between(1, 3.6e6, "ms", SECONDS)] | None = None
    people_speed_m_s: Annotated[NotNegative, AfterValidator(speed_of_people)] = PEOPLE_SPEED_M_S
    nothing_moves: Flag = False
    pass_time_ms: Annotated[Positive, between(1, 6e4, "ms", SECONDS)] | None = None
    recording: RecordingEntry | None = None
    simulated: SimulatedEntry | None = None
    room: RoomEntry | None = None
    placement: PlacementEntry | None = None
    watch: WatchEntry | None = None
    gate: GateEntry | None = None
    black_box: BlackBoxEntry | None = None
    separation: SeparationEntry = SeparationEntry()
    health: HealthEntry = HealthEntry()
    calibration: CalibrationEntry | None = None

    @property
    def has_machine(self) -> bool:
        """Whether there is a machine, or several."""
        return self.machine is not None or bool(self.machines)

    @model_validator(mode="after")
    def _fits_together(self) -> "SiteEntry":
        names = [camera.name for camera in self.cameras]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise ValueError(f"each camera a name of its own; {', '.join(doubled)} is there more than once")
        brings_cameras = self.simulated is not None or isinstance(self.recording, SevenScenes)
        if isinstance(self.recording, SevenScenes) and self.cameras:
            raise ValueError("no list of cameras where layout seven_scenes brings its own")
        if not brings_cameras and not self.cameras and self.placement is None:
            raise ValueError("at least one camera, or simulated, or a recording of layout seven_scenes")
        if self.simulated is not None and self.cameras:
            own = sorted(self.simulated.model_fields_set & set(EVEN_SETTINGS))
            if own:
                raise ValueError(
                    f"a list of cameras, or simulated.{own[0]}, which makes them along the walls; not both"
                )
        if self.simulated is not None and self.room is not None:
            raise ValueError("no key room where the room is simulated: it brings its walls and furniture")
        if self.simulated is not None and self.recording is not None:
            raise ValueError("either simulated or recording, not both")
        if self.simulated is not None and not self.cameras:
            beyond = sorted(self.camera_defaults.model_fields_set - set(SIMULATED_SETTINGS))
            if beyond:
                raise ValueError(
                    f"camera_defaults of a simulated room: {', '.join(SIMULATED_SETTINGS)}; not {beyond[0]}"
                )
        if self.watch is not None and isinstance(self.recording, SevenScenes):
            raise ValueError("no key watch where layout seven_scenes makes a camera of each frame")
        if self.machine is not None and self.machines:
            raise ValueError("either machine or machines, not both")
        across = sorted(self.model_fields_set & {"allowed_contacts", "own_links"})
        if across and not self.machines:
            raise ValueError(
                f"{across[0]} beside machines, for links of all of them; here it belongs into machine"
            )
        if self.joints and not self.has_machine:
            raise ValueError("joints only with a machine")
        try:
            require_speed(self.people_speed_m_s, self.nothing_moves)
        except InputError as error:
            raise ValueError(str(error)) from None
        if self.zones and not self.has_machine:
            raise ValueError("zones only with a machine: they say where its links may be")
        return self
