"""A moment as messages of Foxglove's schemas: values in, messages out."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.extras import package
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.page.foxglove.blocked import FIELD, Blocked
from elbowroom.page.scene.bodies import light_mesh, wxyz_of
from elbowroom.page.story.told import Told
from elbowroom.sensing import DepthFrame

WORLD = "world"
TF, JOINTS, VERDICTS, BLOCKED, MACHINE = "/tf", "/joints", "/verdicts", "/blocked", "/machine"
MOST_LINK_TRIANGLES = 2000
FAR_MM = 65535
MACHINE_COLOUR, CONTACT_COLOUR = (0.78, 0.81, 0.86), (1.0, 0.0, 0.56)
VERDICT_SCHEMA = {
    "type": "object",
    "properties": {
        "sequence": {"type": "integer"},
        "level": {"type": "string"},
        "stopped_by": {"type": ["string", "null"]},
        "fault": {"type": ["string", "null"]},
        "cycle_ms": {"type": "number"},
        "verdicts": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "joint": {"type": "string"},
                    "direction": {"type": ["string", "null"]},
                    "level": {"type": "string"},
                    "free_travel": {"type": "number"},
                    "free_travel_unit": {"type": "string"},
                    "safe_speed": {"type": "number"},
                    "cause": {"type": "string"},
                    "link": {"type": ["string", "null"]},
                    "place_m": {"type": ["array", "null"]},
                },
            },
        },
    },
}
ROW_KEYS = tuple(VERDICT_SCHEMA["properties"]["verdicts"]["items"]["properties"])  # type: ignore[index]
LEVELS = ("stop", "decelerate", "inform", "clear")
"""From the most cautious on."""


def depth_topic(camera: str) -> str:
    """Of a camera's depth images."""
    return f"/cameras/{camera}/depth"


def calibration_topic(camera: str) -> str:
    """Of a camera's calibration."""
    return f"/cameras/{camera}/calibration"


def frame_of(camera: str) -> str:
    """The frame of a camera: x right, y down, z forward."""
    return f"camera/{camera}"


def transforms(
    at_ns: int,
    cameras: tuple[DepthCamera, ...],
    world_from_links: Mapping[str, NDArray[np.float64]],
) -> Any:
    """Where cameras and links are, in the world.

    Args:
        at_ns: time [ns].
        cameras: of the room.
        world_from_links: by link, shape (4, 4).
    """
    poses = {frame_of(camera.name): camera.world_from_camera for camera in cameras}
    poses |= {f"link/{name}": pose for name, pose in world_from_links.items()}
    made, stamp = _messages(), _stamp(at_ns)
    return made.FrameTransforms(
        transforms=[
            made.FrameTransform(
                timestamp=stamp,
                parent_frame_id=WORLD,
                child_frame_id=name,
                translation=_vector(pose[:3, 3]),
                rotation=_quaternion(pose[:3, :3]),
            )
            for name, pose in poses.items()
        ]
    )


def joint_states(at_ns: int, joints: Mapping[str, float]) -> Any:
    """Where the joints are.

    Args:
        at_ns: time [ns].
        joints: positions by name [m or rad].
    """
    made = _messages()
    states = [made.JointState(name=name, position=float(value)) for name, value in joints.items()]
    return made.JointStates(timestamp=_stamp(at_ns), joints=states)


def verdicts(told: Told) -> bytes:
    """What may move how far, as JSON of `VERDICT_SCHEMA`.

    Args:
        told: the moment.
    """
    judged = told["judged"]
    rows = [{key: row[key] for key in ROW_KEYS} for row in judged["verdicts"]]
    levels = [row["level"] for row in rows]
    content = {
        "sequence": told["sequence"],
        # nothing judged is a stop
        "level": min(levels, key=LEVELS.index, default="stop"),
        "stopped_by": judged["stopped_by"],
        "fault": judged["fault"],
        "cycle_ms": sum(judged["stage_ms"].values()),
        "verdicts": rows,
    }
    return json.dumps(content, allow_nan=False).encode()


def voxel_grid(at_ns: int, grid: VoxelGrid, blocked: Blocked) -> Any:
    """Blocked space near the machine; a byte a voxel: 0 free or not shown, 1 surface, 2 unseen, 3 blind.

    Args:
        at_ns: time [ns].
        grid: of the space.
        blocked: what is shown of it.
    """
    made = _messages()
    columns, rows, _ = blocked.kinds.shape
    edge, origin = grid.voxel_size_m, grid.lower_m + blocked.lower * grid.voxel_size_m
    return made.VoxelGrid(
        timestamp=_stamp(at_ns),
        frame_id=WORLD,
        pose=made.Pose(position=_vector(origin), orientation=made.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)),
        row_count=rows,
        column_count=columns,
        cell_size=made.Vector3(x=edge, y=edge, z=edge),
        slice_stride=columns * rows,
        row_stride=columns,
        cell_stride=1,
        fields=[made.PackedElementField(name=FIELD, offset=0, type=made.PackedElementFieldNumericType.Uint8)],
        # slices of z, rows of y, columns of x
        data=np.ascontiguousarray(blocked.kinds.transpose(2, 1, 0)).tobytes(),
    )


def machine_scene(at_ns: int, machine: Machine) -> Any:
    """The links' surfaces, each in its own frame: they move with the transforms.

    Args:
        at_ns: time [ns].
        machine: whose links.
    """
    made = _messages()
    colour = made.Color(r=MACHINE_COLOUR[0], g=MACHINE_COLOUR[1], b=MACHINE_COLOUR[2], a=1.0)
    entities = []
    for link in machine.links:
        if not link.has_geometry:
            continue
        vertices, faces = light_mesh(link.vertices, link.faces, MOST_LINK_TRIANGLES)
        points = [made.Point3(x=float(x), y=float(y), z=float(z)) for x, y, z in vertices]
        surface = made.TriangleListPrimitive(
            points=points, indices=[int(n) for n in faces.ravel()], color=colour
        )
        entities.append(
            made.SceneEntity(
                timestamp=_stamp(at_ns),
                frame_id=f"link/{link.name}",
                id=f"link/{link.name}",
                frame_locked=True,
                triangles=[surface],
            )
        )
    return made.SceneUpdate(entities=entities)


def depth_image(at_ns: int, frame: DepthFrame) -> Any:
    """A depth image in whole millimetres, 0 for no return.

    Args:
        at_ns: time [ns].
        frame: of a camera.
    """
    depth = np.asarray(frame.depth_m, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        valid = np.isfinite(depth) & (depth > 0)
        shown = np.where(valid, np.clip(np.round(np.where(valid, depth, 0) * 1000), 1, FAR_MM), 0)
    height, width = depth.shape
    return _messages().RawImage(
        timestamp=_stamp(at_ns),
        frame_id=frame_of(frame.camera),
        width=width,
        height=height,
        encoding="mono16",
        step=2 * width,
        data=shown.astype("<u2").tobytes(),
    )


def calibration(at_ns: int, camera: DepthCamera) -> Any:
    """What a camera's lens is.

    Args:
        at_ns: time [ns].
        camera: of the room.
    """
    k = camera.intrinsics
    matrix = [k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0]
    return _messages().CameraCalibration(
        timestamp=_stamp(at_ns),
        frame_id=frame_of(camera.name),
        width=camera.width,
        height=camera.height,
        distortion_model="rational_polynomial" if len(k.distortion) == 8 else "plumb_bob",
        D=[float(value) for value in k.distortion],
        K=matrix,
        R=[1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0],
        P=[k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def _messages() -> Any:
    return package("foxglove.messages")


def _stamp(at_ns: int) -> Any:
    return _messages().Timestamp(sec=at_ns // 1_000_000_000, nsec=at_ns % 1_000_000_000)


def _vector(values: Any) -> Any:
    return _messages().Vector3(x=float(values[0]), y=float(values[1]), z=float(values[2]))


def _quaternion(rotation: NDArray[np.float64]) -> Any:
    w, x, y, z = wxyz_of(rotation)
    return _messages().Quaternion(x=x, y=y, z=z, w=w)
