"""Recordings as a site file describes them: three ways in which people lay out depth images, and bags of ROS 2.

`without_machine` says of any that the machine stood in none of its images: they were taken before it was installed.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from elbowroom.site.entry import Entry, Flag, NotNegative, Positive, Text, Whole

StampUnit = Literal["ns", "us", "ms", "s"]
"""Of the times that name images."""


class StampedFolder(Entry):
    """`<folder>/<camera>/<stamp>.png` and, for a machine, a CSV of joints.

    Stamps are whole nanoseconds unless `stamp_unit` says otherwise, or seconds where they have a decimal point; angles
    of joints are radians unless `angle_unit` says otherwise. Frames of different cameras make one moment if they lie
    within `max_skew_ms` of each other. Rows of joints farther apart than `max_joint_gap_ms` have nothing known
    between them. `ignore` names sub-folders of images that belong to no camera.
    """

    layout: Literal["folder"]
    folder: Text
    stamp_unit: StampUnit | None = None
    joints_file: Text = "joints.csv"
    angle_unit: Literal["rad", "deg"] = "rad"
    max_skew_ms: NotNegative = 50.0
    max_joint_gap_ms: Positive = 500.0
    ignore: tuple[Text, ...] = ()
    without_machine: Flag = False


class StamplessFolder(Entry):
    """Images without times: the n-th of each camera, in order of names, make the n-th moment.

    `files` gives per camera a pattern or a list of paths below the folder; what it leaves out is
    `<camera>/*.png`. Numbers in names are in order as numbers: 9 goes before 10.
    """

    layout: Literal["stampless"]
    folder: Text
    files: dict[Text, Text | tuple[Text, ...]] = Field(default_factory=dict)
    without_machine: Flag = False


class SevenScenes(Entry):
    """The layout of 7-Scenes and TSDF-fusion: `frame-NNNNNN.depth.png` and `.pose.txt`, one static room.

    Each frame is a camera of its own; all of them together are one moment. The camera matrix is
    `camera-intrinsics.txt` unless `camera_defaults` says otherwise. `include` (all, if left out) and
    `exclude` name frames by number.
    """

    layout: Literal["seven_scenes"]
    folder: Text
    include: tuple[Whole, ...] | None = None
    exclude: tuple[Whole, ...] = ()
    without_machine: Flag = False

    @model_validator(mode="after")
    def _nothing_in_both(self) -> "SevenScenes":
        both = sorted(set(self.include or ()) & set(self.exclude))
        if both:
            raise ValueError(f"each frame in include or in exclude; {both} in both")
        return self


class BagRecording(Entry):
    """A bag of ROS 2: the folder of `ros2 bag record`, or an MCAP file. `elbowroom site from-bag` writes this.

    `topics` gives each camera its topic of depth images (sensor_msgs/Image of 16UC1 or 32FC1, or the transport
    compressedDepth). Joints come from `joint_topics`, in radians unless `angle_unit` says otherwise. Images of
    different cameras make one moment if they lie within `max_skew_ms` of each other. Nothing is known between two
    positions of a joint that are farther apart than `max_joint_gap_ms`.
    """

    layout: Literal["bag"]
    file: Text
    topics: dict[Text, Text] = Field(min_length=1)
    joint_topics: tuple[Text, ...] = ("/joint_states",)
    angle_unit: Literal["rad", "deg"] = "rad"
    max_skew_ms: NotNegative = 50.0
    max_joint_gap_ms: Positive = 500.0
    without_machine: Flag = False

    @model_validator(mode="after")
    def _each_its_own(self) -> "BagRecording":
        topics = list(self.topics.values())
        doubled = sorted({topic for topic in topics if topics.count(topic) > 1})
        if doubled:
            raise ValueError(f"topics that are each one camera's; {doubled[0]} is there more than once")
        return self


RecordingEntry = Annotated[
    StampedFolder | StamplessFolder | SevenScenes | BagRecording, Field(discriminator="layout")
]
