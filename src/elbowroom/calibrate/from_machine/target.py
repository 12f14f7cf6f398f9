"""Cameras found from the machine itself: no board, only images of it in several poses."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.fit import Known, MachineFit, fit, require_world
from elbowroom.calibrate.from_machine.other_poses import explained
from elbowroom.calibrate.from_machine.start import start
from elbowroom.calibrate.from_machine.surface_sums import SurfaceSums
from elbowroom.calibrate.from_machine.verdict import check_camera, notes_of
from elbowroom.calibrate.from_machine.views import MachineViews, machine_views
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.surface_picture import SurfacePicture
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.sensing import Snapshot

PICTURE_WIDTH_PX = 320
Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class MachineCalibration:
    """What the machine's own surface says.

    Args:
        cameras: in the order given; those that hold exactly are left out.
        machine: where its base is.
        base_covariance: of the twist of world_from_base in the base's frame, rotation vector [rad], then translation
            [m], shape (6, 6); None: the base was not asked for and fixes the world.
        depth_errors: by camera: bias [m] and scale: it reads (1 + scale) times the distance, plus bias.
        poses: how many were used.
        rows: of kind "machine", one a camera: poses and pixels that agree, see through the model, have something before
            it; by how many times poses disagree more than noise explains.
        pictures: of each camera the pose in which most of the machine agrees.
    """

    cameras: tuple[CalibratedCamera, ...]
    machine: Machine
    base_covariance: NDArray[np.float64] | None
    depth_errors: Mapping[str, tuple[float, float]]
    poses: int
    rows: tuple[dict[str, Any], ...]
    pictures: tuple[SurfacePicture, ...]

    def row(self) -> dict[str, Any]:
        """A row of kind "base": where the machine stands."""
        return {
            "kind": "base",
            "machine": self.machine.name,
            "world_from_base": self.machine.world_from_base.tolist(),
            "covariance": None if self.base_covariance is None else self.base_covariance.tolist(),
            "poses": self.poses,
        }


def calibrate_from_machine(
    machine: Machine,
    cameras: Sequence[DepthCamera],
    moments: Iterable[Snapshot],
    *,
    hold: Mapping[str, NDArray[np.float64] | None] | None = None,
    free_base: bool = False,
    model_sigma_m: float | None = None,
    progress: Progress = lambda words: None,
) -> MachineCalibration:
    """Poses of cameras from images of a machine that went through poses.

    The machine's base fixes the world. With `free_base` it is found as well, and cameras of `hold` fix the world.

    Args:
        machine: its model and base; with `free_base`, roughly where the base is (10 cm, 5 degrees).
        cameras: with rough poses (10 cm, 5 degrees), and noise.
        moments: one per pose of the machine, with its joints; twelve or more are good.
        hold: cameras whose poses are known, by name: covariance of the twist, shape (6, 6), or None: exactly.
        free_base: whether to find the base.
        model_sigma_m: how well the model fits the machine [m]; None: 2 mm.
        progress: told what is being done.

    Raises:
        CalibrationError: joints are not known, too few poses, a camera that does not see the machine, that its poses
            do not fix, or whose rough pose is too far off. No pose is guessed.
    """
    progress("reading images")
    views = machine_views(machine, cameras, moments)
    known = _known(views, hold or {})
    drawn = DrawnMachine(machine, machine.world_from_base)
    progress("first poses")
    starts = dict(
        zip(
            (v.camera.name for v in views),
            _all_or_named(lambda v: start(drawn, v), views, machine),
            strict=True,
        )
    )
    if free_base:
        machine = replace(machine, world_from_base=_first_base(machine, starts, known))
        starts = _with_base(drawn, machine, starts, known)
    progress("least squares")
    found = fit(
        machine,
        views,
        starts,
        known,
        free_base=free_base,
        model_sigma_m=model_sigma_m,
        done=lambda: progress("least squares"),
    )
    machine = replace(machine, world_from_base=found.world_from_base)
    _all_or_named(lambda v: check_camera(machine, v, found), views, machine)
    calibrated = tuple(
        _calibrated(v, found, notes_of(machine, v, found))
        for v in views
        if v.camera.name in found.covariances
    )
    drawn = DrawnMachine(machine, machine.world_from_base)
    return MachineCalibration(
        calibrated,
        machine,
        found.base_covariance,
        {name: (float(bias), float(scale)) for name, (bias, scale) in found.depth_errors.items()},
        len(np.unique(np.concatenate([v.poses for v in views]))),
        tuple(_row(v, found) for v in views),
        tuple(_picture(drawn, v, found) for v in views),
    )


def _known(views: Sequence[MachineViews], hold: Mapping[str, NDArray[np.float64] | None]) -> dict[str, Known]:
    poses = {v.camera.name: v.camera.world_from_camera for v in views}
    for name in hold:
        if name not in poses:
            raise CalibrationError(f"hold: no camera {name!r}; cameras are {', '.join(poses)}")
    return {name: Known(poses[name], covariance) for name, covariance in hold.items()}


def _all_or_named(work: Callable, views: Sequence[MachineViews], machine: Machine) -> list:
    """Does work for each camera; if it fails for any, all of them are named in the one error, with what would fit."""

    def tried(view: MachineViews) -> object:
        try:
            return work(view)
        except CalibrationError as error:
            return error

    results = spread(tried, views)
    errors = [(v, r) for v, r in zip(views, results, strict=True) if isinstance(r, CalibrationError)]
    if not errors:
        return results
    refused = [v.camera.name for v, _ in errors]
    others = ", ".join(refused[1:])
    first, error = errors[0]
    why = explained(machine, first, views, refused)
    said = str(error) if why is None else f"camera {refused[0]}: {why}; as it is: {error}"
    raise CalibrationError(said + (f" (and the same or the like for {others})" if others else ""))


def _first_base(
    machine: Machine, starts: Mapping[str, NDArray[np.float64]], known: Mapping[str, Known]
) -> NDArray[np.float64]:
    """Where the base is, from the first camera whose pose is known and its pose relative to the base."""
    require_world(known)
    name, first = next(iter(known.items()))
    camera_from_base = invert_rigid(starts[name]) @ machine.world_from_base
    return first.world_from_camera @ camera_from_base


def _with_base(
    drawn: DrawnMachine,
    machine: Machine,
    starts: Mapping[str, NDArray[np.float64]],
    known: Mapping[str, Known],
) -> dict[str, NDArray[np.float64]]:
    """The first poses of the cameras relative to the base as it is now; cameras that hold stay."""
    new_from_old = machine.world_from_base @ invert_rigid(drawn.world_from_base)
    return {
        name: known[name].world_from_camera
        if name in known and known[name].covariance is None
        else new_from_old @ pose
        for name, pose in starts.items()
    }


def _calibrated(views: MachineViews, found: MachineFit, notes: tuple[str, ...]) -> CalibratedCamera:
    name, sums = views.camera.name, found.sums[views.camera.name]
    along_ray = sums.residuals * views.images.thinned.radial_over_planar
    return CalibratedCamera(
        camera=replace(views.camera, world_from_camera=found.world_from_cameras[name]),
        before=views.camera,
        covariance=found.covariances[name],
        residuals_px=np.zeros(0),
        residuals_m=along_ray[np.isfinite(along_ray)],
        notes=notes,
    )


def _row(views: MachineViews, found: MachineFit) -> dict[str, Any]:
    name, sums = views.camera.name, found.sums[views.camera.name]
    bias, scale = found.depth_errors[name]
    off = sums.residuals[np.isfinite(sums.residuals)]
    return {
        "kind": "machine",
        "camera": name,
        "poses": int((np.isfinite(sums.residuals).sum(axis=(1, 2)) > 0).sum()),
        "pixels": sums.agreeing,
        "through": sums.behind,
        "before": sums.before,
        "silent": sums.silent,
        "rms_m": float(np.sqrt(np.mean(off.astype(float) ** 2))),
        "median_m": float(np.median(off)),
        "bias_m": float(bias),
        "scale": float(scale),
        "inflation": found.inflation[name],
    }


def _picture(drawn: DrawnMachine, views: MachineViews, found: MachineFit) -> SurfacePicture:
    name = views.camera.name
    sums: SurfaceSums = found.sums[name]
    agrees = np.isfinite(sums.residuals)
    row = int(np.argmax(agrees.sum(axis=(1, 2))))
    camera = views.images.at(found.world_from_cameras[name])
    inverse = drawn.image(camera, views.base_from_links[row]).inverse
    expected = np.where(inverse > 0, 1 / np.where(inverse > 0, inverse, 1), 0).astype(np.float32)
    return SurfacePicture(name, f"pose {views.poses[row]}", views.images.depth_m[row], expected, agrees[row])
