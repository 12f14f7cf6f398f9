"""The simulated room before four small cameras, for a second: as a bag, and as a folder with the same numbers."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import yaml
from PIL import Image as Picture

from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.sources.recording_folder import Units
from reference import bag_files as bags

MOMENTS, STEP_NS, LATE_NS = 4, 100 * bags.MS, 12 * bags.MS
JOINT_STEP_NS = 20 * bags.MS


@dataclass(frozen=True)
class BagRoom:
    """What was seen: by camera and stamp the whole numbers [mm]; by stamp the joints."""

    cameras: tuple
    raw: dict
    joints: dict

    def messages(self, kind="16UC1"):
        """All that a recorder would get of it, by time of receipt."""
        found = [
            (
                "/tf_static",
                bags.T0 - 1,
                bags.transforms(bags.transform("world", f"{c.name}_optical", c.world_from_camera)),
            )
            for c in self.cameras
        ]
        for camera in self.cameras:
            frame = f"{camera.name}_optical"
            for stamp, numbers in self.raw[camera.name].items():
                at = stamp + LATE_NS
                topic, sent = _sent(camera.name, numbers, stamp, frame, kind)
                found.append((topic, at, sent))
                info = bags.camera_info(camera, stamp, frame)
                found.append((f"/{camera.name}/depth/camera_info", at, info))
        for stamp, joints in self.joints.items():
            found.append(("/joint_states", stamp + bags.MS, bags.joint_state(joints, stamp)))
        return sorted(found, key=lambda message: message[1])

    def write_folder(self, out):
        """The same as images of a folder."""
        for name, images in self.raw.items():
            (out / name).mkdir(parents=True)
            for stamp, numbers in images.items():
                Picture.fromarray(numbers).save(out / name / f"{stamp}.png")
        names = list(next(iter(self.joints.values())))
        rows = [",".join(["stamp_ns", *names])]
        rows += [",".join([str(at), *(repr(j[n]) for n in names)]) for at, j in self.joints.items()]
        (out / "joints.csv").write_text("\n".join(rows) + "\n")

    def site(self, path, recording, **more):
        """A site file of it with a recording."""
        content = {
            "grid": {"origin_m": [-2, -2, 0], "upper_m": [2, 2, 2.4], "voxel_size_m": 0.1},
            "camera_defaults": {"noise": "tof", "depth_scale_m": 0.001, "repeats": True},
            "cameras": [
                {
                    "name": c.name,
                    "width": c.width,
                    "height": c.height,
                    **{k: getattr(c.intrinsics, k) for k in ("fx", "fy", "cx", "cy")},
                    "world_from_camera": np.asarray(c.world_from_camera).tolist(),
                }
                for c in self.cameras
            ],
            "machine": {"builtin": "ceiling_c_arm"},
            "joints": {"larm": {"max_speed_deg_s": 12, "braking_time_s": 0.5}},
            "recording": recording,
            **more,
        }
        Path(path).write_text(yaml.safe_dump(content))
        return Path(path)

    def recording(self, place, kind="16UC1"):
        """What a site says of a bag of it."""
        topics = {camera.name: _topic(camera.name, kind) for camera in self.cameras}
        return {"layout": "bag", "file": str(place), "topics": topics}


@cache
def bag_room():
    """The room, rendered once."""
    cameras = wall_cameras(4, 2.2, 48, 36)
    room, units = InterventionRoom(), Units(0.001)
    raw = {camera.name: {} for camera in cameras}
    for number in range(MOMENTS):
        frames = render(cameras, room.at(number * STEP_NS / 1e9), seed=number)
        for camera, frame in zip(cameras, frames, strict=True):
            raw[camera.name][bags.T0 + number * STEP_NS] = units.of(frame.depth_m)
    steps = range(MOMENTS * STEP_NS // JOINT_STEP_NS)
    joints = {bags.T0 + n * JOINT_STEP_NS: dict(room.at(n * JOINT_STEP_NS / 1e9).joints) for n in steps}
    return BagRoom(cameras, raw, joints)


def _topic(name, kind):
    return f"/{name}/depth/image_raw" + ("/compressedDepth" if kind in ("png", "quantised") else "")


def _sent(name, numbers, stamp, frame, kind):
    metres = numbers.astype(np.float32) * np.float32(0.001)
    if kind == "png":
        sent = bags.compressed(bags.png(numbers), stamp, frame, "16UC1; compressedDepth png")
    elif kind == "quantised":
        codes, quant = bags.quantised(metres)
        sent = bags.compressed(bags.png(codes), stamp, frame, "32FC1; compressedDepth", quant)
    elif kind == "32FC1":
        sent = bags.image(np.where(numbers > 0, metres, np.nan).astype(np.float32), stamp, frame)
    else:
        sent = bags.image(numbers, stamp, frame, big=kind == "big", padding=6 if kind == "padded" else 0)
    return _topic(name, kind), sent
