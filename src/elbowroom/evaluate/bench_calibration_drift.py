"""The drift watch measured in the simulated room: knocks named, false alarms, wrong joints, its time.

Frames come at 30 Hz. Everything is rendered anew with noise of its own; the reference is commissioned in the same room
while people walk and the machine moves.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from elbowroom.calibrate.commissioning.commission import Commissioning
from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health import Condition
from elbowroom.monitor.reference import CameraReference
from elbowroom.monitor.watch import BODY, TURNS, Watch
from elbowroom.sensing import NOISE_PRESETS, DepthFrame
from elbowroom.simulate import InterventionRoom, Moment, Solid, render, wall_cameras
from elbowroom.simulate.knock import Knock
from elbowroom.simulate.person import Person, Walk
from elbowroom.simulate.room import STAFF
from elbowroom.site import Site, moments

PERIOD_S = 1 / 30
HEIGHTS_M = (2.4, 0.4)
COMMISSION_FRAMES = 20
KNOCKED_FRAMES = 60
"""2 s: by then a knock must have been named."""
BEFORE = 6
"""Frames before the knock."""
EVERY = 3
"""One camera in so many is knocked where several are at once."""
KNOCKS: dict[str, Knock] = {
    **{
        f"turn 1 degree about {a}": Knock("", tuple(np.radians(np.eye(3)[i])), (0, 0, 0))
        for i, a in enumerate("xyz")
    },
    **{f"move 2 cm along {a}": Knock("", (0, 0, 0), tuple(0.02 * np.eye(3)[i])) for i, a in enumerate("xyz")},
}
WRONG_JOINTS: dict[str, tuple[float, ...]] = {
    "long": (0.03,),
    "larm": (float(np.radians(2.0)),),
    "propeller": (float(np.radians(-3.0)),),
    "carc": (float(np.radians(3.0)),),
}
"""Joint and what it says too much [m or rad]."""
VISITORS = (
    Person("visitor 1", Walk((0.0, -1.45), (1.5, 0.25), 16.0, start_rad=0.4), 1.85),
    Person("visitor 2", Walk((-1.6, 0.1), (0.2, 1.3), 13.0, start_rad=2.0), 1.60),
)
"""Who else walks, close to the walls and cameras, where false alarms are looked for."""
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class Commissioned:
    """A room whose cameras have a reference.

    Args:
        room: with people.
        cameras: along its walls.
        references: of these.
        noise: name of the cameras' noise.
    """

    room: InterventionRoom
    cameras: tuple[DepthCamera, ...]
    references: tuple[CameraReference, ...]
    noise: str

    def watch(self) -> Watch:
        """A new watch over it."""
        return Watch(self.cameras, self.references, self.room.machine)

    @property
    def words(self) -> dict[str, Any]:
        """What rows say of it."""
        first = self.cameras[0]
        return {
            "cameras": len(self.cameras), "width": first.width, "height": first.height, "noise": self.noise,
        }  # fmt: skip


def commissioned(
    noise: str, width: int = 160, height: int = 120, count: int = 21, staff: Sequence[Person] = STAFF
) -> Commissioned:
    """The simulated room with cameras at two heights in turn, commissioned over 14 s."""
    cameras = wall_cameras(
        count, HEIGHTS_M, width, height, noise=NOISE_PRESETS.get(noise), min_depth_m=0.1, max_depth_m=8.0
    )
    room = InterventionRoom(staff=staff)
    commissioning = Commissioning(cameras, room.machine, COMMISSION_FRAMES)
    for number in range(COMMISSION_FRAMES):
        moment = room.at(200 + 0.7 * number)
        commissioning.add(render(cameras, moment, seed=number), moment.joints)
    return Commissioned(room, cameras, commissioning.references(), noise)


PARTS = ("knocks", "joints", "furniture", "alarms", "real", "time")


def drift_rows(
    tell: Tell, parts: Sequence[str] = PARTS, *, passes: int = 1000, recorded: Site | None = None
) -> Iterator[dict[str, Any]]:
    """The rows of some parts; each row has keys `part` and `case`.

    Args:
        tell: called with what is done next, in words.
        parts: of `PARTS`.
        passes: for false alarms; each brings ten or eleven frames that are listened to.
        recorded: site of a real recording for part `real`; None: it is left out.
    """
    for noise in ("tof", "kinect_v1"):
        if {"knocks", "joints", "furniture"} & set(parts):
            tell(f"commissioning, noise {noise}")
            scene = commissioned(noise)
        if "knocks" in parts:
            yield from knock_rows(scene, tell)
        if "joints" in parts:
            yield from joint_rows(scene, tell)
        if "furniture" in parts:
            yield furniture_row(scene, tell)
        if "alarms" in parts:
            yield false_alarm_row(commissioned(noise, staff=STAFF + VISITORS), passes, tell)
    if "real" in parts and recorded is not None:
        yield from real_rows(recorded, tell)
    if "time" in parts:
        yield time_row(tell)


def knock_rows(scene: Commissioned, tell: Tell) -> Iterator[dict[str, Any]]:
    """Each camera is knocked in each way, alone, while all others stay; and several at once.

    Yields:
        Rows of `knock`, `runs`, `named` (that camera, within 60 frames), `others_named`, `frames_median`, `frames_max`,
        `true` and `said_median` [deg or mm], `error_p95`, `inside_2_sigma_pct`, `not_named`: cameras, and what their
        reference does not show.
    """
    start_s = 50.0
    still = [
        _frames(scene.cameras, scene.room.at(start_s + k * PERIOD_S), k)
        for k in range(BEFORE + KNOCKED_FRAMES)
    ]
    for name, knock in KNOCKS.items():
        tell(f"{name}, noise {scene.noise}")
        turns = any(knock.turn_rad)
        frames, said, sigmas, missed, others = [], [], [], [], 0
        for number, camera in enumerate(scene.cameras):
            watch = scene.watch()
            truly = knock.camera(camera)
            for k, joints in enumerate(_joints(scene, start_s, len(still))):
                now = list(still[k])
                if k >= BEFORE:
                    now[number] = _frames([truly], scene.room.at(start_s + k * PERIOD_S), 5000 + k)[0]
                health = watch.hear(now, joints, now[0].stamp_ns or 0)
                if camera.name in health.stops:
                    break
            others += len(set(health.stops) - {camera.name})
            shift = watch.shift_of(camera.name)
            if shift is None:
                unseen = scene.references[number].unseen_motions(np.radians(0.4), 0.008)
                missed.append({"camera": camera.name, "reference_does_not_show": list(unseen)})
                continue
            frames.append(k + 1 - BEFORE)
            said.append(shift.turn_deg if turns else shift.move_mm)
            sigmas.append(shift.turn_sigma_deg if turns else shift.move_sigma_mm)
        true = 1.0 if turns else 20.0
        errors = np.abs(np.array(said) - true)
        yield {
            "part": "knocks",
            "case": "knock",
            "knock": name,
            **scene.words,
            "runs": len(scene.cameras),
            "named": len(said),
            "others_named": others,
            "frames_median": float(np.median(frames)) if frames else None,
            "frames_max": max(frames, default=None),
            "unit": "deg" if turns else "mm",
            "true": true,
            "said_median": float(np.median(said)) if said else None,
            "error_p95": float(np.percentile(errors, 95)) if said else None,
            "inside_2_sigma_pct": float(100 * np.mean(errors <= 2 * np.array(sigmas))) if said else None,
            "not_named": missed,
        }
    yield _several_row(scene, still, start_s)


def _several_row(
    scene: Commissioned, still: Sequence[Sequence[DepthFrame]], start_s: float
) -> dict[str, Any]:
    """Every third camera turns by a degree about its y axis at once."""
    knock = KNOCKS["turn 1 degree about y"]
    knocked = {camera.name for camera in scene.cameras[::EVERY]}
    watch = scene.watch()
    for k, joints in enumerate(_joints(scene, start_s, len(still))):
        moment = scene.room.at(start_s + k * PERIOD_S)
        now = [
            _frames([knock.camera(camera)], moment, 5000 + k)[0]
            if camera.name in knocked and k >= BEFORE
            else frame
            for camera, frame in zip(scene.cameras, still[k], strict=True)
        ]
        health = watch.hear(now, joints, moment.stamp_ns)
        if knocked <= set(health.stops):
            break
    return {
        "part": "knocks",
        "case": "knock",
        "knock": f"{len(knocked)} cameras at once, turn 1 degree about y",
        **scene.words,
        "runs": len(knocked),
        "named": len(knocked & set(health.stops)),
        "others_named": len(set(health.stops) - knocked),
        "frames_max": k + 1 - BEFORE,
    }


def joint_rows(scene: Commissioned, tell: Tell) -> Iterator[dict[str, Any]]:
    """A joint says more than is true; all cameras stand still.

    Yields:
        Rows of `joint`, `wrong_by` [m or rad], `found`, `frames`, `reason`, `cameras_named`.
    """
    for joint, amounts in WRONG_JOINTS.items():
        for amount in amounts:
            tell(f"{joint} wrong, noise {scene.noise}")
            watch = scene.watch()
            for k in range(BEFORE + KNOCKED_FRAMES):
                moment = scene.room.at(30.0 + k * PERIOD_S)
                joints = dict(moment.joints)
                joints[joint] += amount if k >= BEFORE else 0.0
                health = watch.hear(_frames(scene.cameras, moment, k), joints, moment.stamp_ns)
                if health.stops:
                    break
            yield {
                "part": "joints",
                "case": "wrong joint",
                "joint": joint,
                "wrong_by": amount,
                **scene.words,
                "found": BODY in health.stops,
                "frames": k + 1 - BEFORE if health.stops else None,
                "reason": health.stops.get(BODY),
                "cameras_named": len(set(health.stops) - {BODY}),
            }


def furniture_row(scene: Commissioned, tell: Tell) -> dict[str, Any]:
    """Table and patient are pushed by 10 cm: no camera moved, and none may be named."""
    tell(f"table pushed, noise {scene.noise}")
    watch = scene.watch()
    shift = np.eye(4)
    shift[:2, 3] = 0.08, 0.06
    moved: dict[str, Solid] = {}
    for k in range(BEFORE + KNOCKED_FRAMES):
        moment = scene.room.at(80.0 + k * PERIOD_S)
        if k >= BEFORE:
            solids = tuple(_pushed(solid, shift, moved) for solid in moment.solids)
            moment = Moment(moment.time_s, solids, moment.joints)
        health = watch.hear(_frames(scene.cameras, moment, k), moment.joints, moment.stamp_ns)
    return {
        "part": "furniture",
        "case": "furniture",
        "what": "table and patient pushed by 10 cm",
        **scene.words,
        "moments": KNOCKED_FRAMES,
        "cameras_named": len(health.stops),
        "reasons": list(health.stops.values()),
    }


def _pushed(solid: Solid, shift: np.ndarray, moved: dict[str, Solid]) -> Solid:
    if solid.name not in ("table", "patient"):
        return solid
    if solid.name not in moved:
        moved[solid.name] = replace(solid, world_from_solid=shift @ solid.world_from_solid)
    return moved[solid.name]


def false_alarm_row(scene: Commissioned, passes: int, tell: Tell) -> dict[str, Any]:
    """People walk and the machine moves; nothing is knocked.

    A watch listens to every other camera at each pass, in turn, so only those are rendered: each frame is new, is
    listened to, and counts once. After an alarm a new watch goes on.
    """
    alarms: list[str] = []
    watch, listened, said_moved, unsure = scene.watch(), 0, 0, 0
    frames = _frames(scene.cameras, scene.room.at(400.0), 0)
    for k in range(passes):
        if k % 50 == 0:
            tell(f"false alarms, noise {scene.noise}, pass {k} of {passes}")
        moment = scene.room.at(400.0 + k * PERIOD_S)
        turn = slice(watch.turn, None, TURNS)
        frames[turn] = _frames(scene.cameras[turn], moment, k)
        health = watch.hear(frames, moment.joints, moment.stamp_ns)
        heard = [camera.condition for camera in health.cameras[turn]]
        listened += len(heard)
        said_moved += sum(condition is Condition.MOVED for condition in heard)
        unsure += sum(condition not in (Condition.MOVED, Condition.STILL) for condition in heard)
        if health.stops:
            alarms.extend(health.stops.values())
            watch = scene.watch()
    return {
        "part": "alarms",
        "case": "false alarms",
        **scene.words,
        "passes": passes,
        "seconds": passes * PERIOD_S,
        "people": len(scene.room.staff),
        "camera_frames": listened,
        "false_alarms": len(alarms),
        "reasons": alarms,
        "frames_that_said_moved_pct": 100 * said_moved / listened,
        "frames_that_could_not_tell_pct": 100 * unsure / listened,
    }


def real_rows(site: Site, tell: Tell, passes: int = 90) -> Iterator[dict[str, Any]]:
    """A recording of fixed cameras before which things are moved, played again and again.

    Every other moment is commissioned, and all are heard. A knock cannot be made afterwards; instead the first camera's
    reference is that of a camera that stood a degree or 2 cm elsewhere, exactly, since its surfaces are planes.

    Args:
        site: with a recording and no machine.
        tell: called with what is done next, in words.
        passes: how many moments are heard.

    Yields:
        Rows of `knock`, `named` and `others_named`, `said` and its two sigmas, as for simulated knocks.
    """
    tell(f"real: {site.name}")
    cameras, seen = site.cameras(), [moment.frames for moment in moments(site)]
    commissioning = Commissioning(cameras, None, len(seen[::2]))
    for frames in seen[::2]:
        commissioning.add(frames, None)
    references = commissioning.references()
    for name, knock in {"none": Knock(""), **KNOCKS}.items():
        watch = Watch(cameras, [commissioned_elsewhere(references[0], knock), *references[1:]])
        for k in range(passes):
            health = watch.hear(seen[k % len(seen)], None, k)
            if health.stops:
                break
        shift = watch.shift_of(cameras[0].name)
        turns = any(knock.turn_rad)
        yield {
            "part": "real",
            "case": "real",
            "site": site.name,
            "knock": name,
            "named": cameras[0].name in health.stops,
            "others_named": len(set(health.stops) - {cameras[0].name}),
            "passes": k + 1,
            "unit": None if shift is None else "deg" if turns else "mm",
            "said": None if shift is None else shift.turn_deg if turns else shift.move_mm,
            "two_sigma": None
            if shift is None
            else 2 * (shift.turn_sigma_deg if turns else shift.move_sigma_mm),
        }


def commissioned_elsewhere(reference: CameraReference, knock: Knock) -> CameraReference:
    """What a reference would be, had its camera stood elsewhere: the same planes, met by the same rays from there.

    Args:
        reference: of the camera where it stands.
        knock: that would bring it there, in its own axes.
    """
    rotation, move = knock.old_from_new[:3, :3], knock.old_from_new[:3, 3]
    normal = reference.normal @ rotation
    direction = reference.points_in_camera / reference.depth_m[:, None]
    towards = np.sum(normal * direction, axis=1)
    depth = np.sum(reference.normal * (reference.points_in_camera - move), axis=1) / towards
    kept = (depth > 0) & (towards < -0.1)
    return replace(
        reference,
        pixel=reference.pixel[kept],
        depth_m=depth[kept],
        sigma_m=reference.sigma_m[kept],
        ray=reference.ray[kept],
        normal=normal[kept],
    )


def time_row(tell: Tell, passes: int = 100) -> dict[str, Any]:
    """What the watch adds to a pass: 21 cameras of 640 x 480 pixels, body included."""
    tell("time of a pass")
    scene = commissioned("kinect_v1", 640, 480)
    shown = [scene.room.at(20.0 + 0.5 * k) for k in range(4)]
    frames = [_frames(scene.cameras, moment, k) for k, moment in enumerate(shown)]
    watch, times, cpu = scene.watch(), [], []
    for k in range(passes + 12):
        stamp = int(k * PERIOD_S * 1e9)
        now = [DepthFrame(f.camera, stamp, f.depth_m) for f in frames[k % 4]]
        begun, worked = time.perf_counter(), time.process_time()
        watch.hear(now, shown[k % 4].joints, stamp)
        times.append((time.perf_counter() - begun) * 1e3)
        cpu.append((time.process_time() - worked) * 1e3)
    p50, p99, worst = np.percentile(times[12:], (50, 99, 100))
    return {
        "part": "time",
        "case": "time",
        **scene.words,
        "passes": passes,
        "median_ms": float(p50),
        "p99_ms": float(p99),
        "max_ms": float(worst),
        "cpu_median_ms": float(np.median(cpu[12:])),
    }


def _frames(cameras: Sequence[DepthCamera], moment: Moment, seed: int) -> list[DepthFrame]:
    return render(cameras, moment, seed=10_000 + seed)


def _joints(scene: Commissioned, start_s: float, count: int) -> Iterator[dict[str, float]]:
    return (scene.room.at(start_s + k * PERIOD_S).joints for k in range(count))
