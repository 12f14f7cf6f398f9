"""Whether a camera's pose is fixed by what it saw of the machine, and what would fix it better."""

import numpy as np

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.fit import MachineFit
from elbowroom.calibrate.from_machine.surface_sums import SurfaceSums
from elbowroom.calibrate.from_machine.views import MachineViews
from elbowroom.calibrate.result.pose_words import deviations, weakest_words
from elbowroom.errors import CalibrationError
from elbowroom.machine import Machine

FEWEST_PIXELS, FEWEST_POSES = 200, 3
"""Pixels that must agree, and poses of which each has a share of them."""
FEW_IN_POSE = 20
THROUGH = 0.05
"""Share of pixels that may see through the model."""
LEAST_AGREEING = 0.25
"""Share of the pixels with a return that must agree: fewer, and something stands before the machine all the time."""
UNFIXED_M, UNFIXED_RAD = 0.010, np.radians(0.3)
"""One sigma in the weakest direction: beyond, the pose is not found."""
WEAK_M, WEAK_RAD = 0.003, np.radians(0.1)
"""One sigma beyond which it is said what would help."""
DEPTH_OFF_M, DEPTH_OFF = 0.01, 0.01
"""Errors of the depth itself that are worth a note [m, 1]."""
HARDLY = 0.1
"""A joint that went through less than this share of its range hardly moved."""


def check_camera(machine: Machine, views: MachineViews, found: MachineFit) -> None:
    """Refuses a pose that the images do not bear out.

    Args:
        machine: at the base that was found.
        views: of the camera.
        found: by the least squares.

    Raises:
        CalibrationError: the machine is hardly in view, is not where the pose says, or leaves a direction free.
    """
    name = views.camera.name
    sums = found.sums[name]
    poses = _poses_with_pixels(sums)
    judged = sums.agreeing + sums.behind + sums.before
    if sums.seen < FEWEST_PIXELS:
        raise CalibrationError(
            f"camera {name}: the machine is not in its view ({sums.seen} pixels in all poses); move it there, or leave "
            "the camera out"
        )
    if sums.behind > THROUGH * max(sums.agreeing + sums.behind, 1) or sums.agreeing < LEAST_AGREEING * judged:
        raise CalibrationError(
            f"camera {name}: no pose suits: {sums.agreeing} of {judged} pixels agree with the machine's model, "
            f"{sums.behind} see through it; give a rough pose within 10 cm and 5 degrees, and look whether joints and "
            "model are the machine's own"
        )
    if sums.agreeing < FEWEST_PIXELS or poses < FEWEST_POSES:
        raise CalibrationError(
            f"camera {name}: {sums.agreeing} pixels in {poses} poses agree with the machine, at least {FEWEST_PIXELS} "
            f"in {FEWEST_POSES} are needed; {_advice(machine, views, found)}"
        )
    if name not in found.covariances:
        return
    place_m, turn = deviations(found.covariances[name])
    if place_m > UNFIXED_M or turn > UNFIXED_RAD:
        raise CalibrationError(
            f"camera {name}: the poses do not fix it: {weakest_words(found.covariances[name])} is known to "
            f"{_size(place_m, turn)} only; {_advice(machine, views, found)}"
        )
    if not found.converged[name]:
        raise CalibrationError(
            f"camera {name}: does not come to rest; give a rough pose within 10 cm and 5 degrees, or more poses"
        )


def notes_of(machine: Machine, views: MachineViews, found: MachineFit) -> tuple[str, ...]:
    """What is weak about a camera's pose, a sentence each.

    Args:
        machine: that was seen.
        views: of the camera.
        found: what the fit came to.
    """
    name, sums = views.camera.name, found.sums[views.camera.name]
    notes = []
    place_m, turn = deviations(found.covariances[name])
    if place_m > WEAK_M or turn > WEAK_RAD:
        notes.append(
            f"{name}: {weakest_words(found.covariances[name])} is known to {_size(place_m, turn)} only; "
            f"{_advice(machine, views, found)}"
        )
    if found.inflation[name] > 20:
        notes.append(
            f"{name}: poses disagree by {np.sqrt(found.inflation[name]):.0f} times what noise explains; look at the "
            "joints' zero positions and at the machine's model"
        )
    bias, scale = found.depth_errors[name]
    if abs(bias) > DEPTH_OFF_M or abs(scale) > DEPTH_OFF:
        notes.append(
            f"{name}: its depth reads {bias * 1e3:+.0f} mm and {scale * 100:+.1f} % off; its margin allows for it, or "
            "calibrate intrinsics and depth_scale_m"
        )
    if sums.before > sums.agreeing:
        notes.append(
            f"{name}: something stands before the machine in most of its view; a capture without people says more"
        )
    return tuple(notes)


def _poses_with_pixels(sums: SurfaceSums) -> int:
    return int((np.isfinite(sums.residuals).sum(axis=(1, 2)) >= FEW_IN_POSE).sum())


def _size(place_m: float, turn: float) -> str:
    def words(value: float, unit: str, digits: int, most: float) -> str:
        return f"{value:.{digits}f} {unit}" if value < most else f"more than {most:g} {unit}"

    return f"{words(place_m * 1e3, 'mm', 1, 1000)} and {words(float(np.degrees(turn)), 'degrees', 2, 90)}"


def _advice(machine: Machine, views: MachineViews, found: MachineFit) -> str:
    """Which links the camera sees, and which joints would show it more."""
    drawn = DrawnMachine(machine, machine.world_from_base)
    coarse = views.coarser(max(1, views.images.thinned.width // 80))
    camera = coarse.images.at(found.world_from_cameras[views.camera.name])
    seen: dict[str, int] = {}
    for links in coarse.base_from_links:
        for link, pixels in drawn.links_seen(camera, links).items():
            seen[link] = seen.get(link, 0) + pixels
    total = max(sum(seen.values()), 1)
    shown = [link for link, pixels in seen.items() if pixels > 0.02 * total]
    ranges = np.ptp(views.positions, axis=0)
    hardly = [
        name
        for name, moved in zip(machine.joint_names, ranges, strict=True)
        if moved < HARDLY * min(machine.joint(name).upper - machine.joint(name).lower, 2 * np.pi)
    ]
    joints = hardly or [
        name for name in machine.joint_names if not set(machine.moved_links(name)) & set(shown)
    ]
    seeing = f"it sees only {', '.join(shown)}" if shown else "it sees nothing of the machine"
    moves = (
        f"move {' and '.join(joints)}" if joints else "turn what it sees into more directions, nearer to it"
    )
    return f"{seeing}: {moves} in its view"
