"""One least squares over all cameras, all poses and, if asked, the machine's base."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.kernels.surface import Trust
from elbowroom.calibrate.from_machine.surface_sums import (
    TRUST,
    SurfaceSums,
    depth_error_step,
    of_pose,
    surface_sums,
    whole,
)
from elbowroom.calibrate.from_machine.views import MachineViews
from elbowroom.errors import CalibrationError
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.parallel import spread
from elbowroom.geometry.twist import adjoint, between, moved
from elbowroom.machine import Machine

STAGES: tuple[tuple[int, float, int], ...] = (
    (2, 0.02, 3),
    (2, 0.01, 3),
    (2, 0.005, 3),
    (1, 0.0, 24),
)
"""Every so many pixels, so much added to sigma [m], at most so many steps."""
STILL = 0.05
"""A step of fewer sigmas, as the images know the pose, is the last one."""
RESTLESS = 0.5
"""Pixels that come and go keep the pose swinging a little: steps that stay longer than this never came to rest."""
HALF_AFTER = 6
"""Steps of a stage after which they are halved, so that such swinging dies down."""
DAMPING = np.array([0.05] * 3 + [0.1] * 3) ** -2.0
"""A direction that the images leave free to this [rad, m] is hardly moved; what they know better is not held back."""
EASE = 1e-9
"""Keeps the covariance finite where a direction is free, and large."""

Array = NDArray[Any]


class Known(NamedTuple):
    """What is known of a camera beforehand: pose and covariance of its twist, shape (6, 6); None: it holds exactly."""

    world_from_camera: Array
    covariance: Array | None


@dataclass(frozen=True, slots=True, eq=False)
class MachineFit:
    """What the least squares found.

    Args:
        world_from_cameras: by camera, shape (4, 4).
        world_from_base: shape (4, 4).
        covariances: of each camera's twist, shape (6, 6).
        base_covariance: of the base's twist in its own frame, shape (6, 6); None: it was not asked for.
        sums: what each camera's images say at the end.
        depth_errors: by camera: bias [m] and scale of its depth, shape (2,): it reads (1 + scale) times the distance,
            plus bias.
        inflation: by camera: by how much its images disagree from pose to pose more than their noise explains.
        converged: whether the last step was small.
    """

    world_from_cameras: Mapping[str, Array]
    world_from_base: Array
    covariances: Mapping[str, Array]
    base_covariance: Array | None
    sums: Mapping[str, SurfaceSums]
    depth_errors: Mapping[str, Array]
    inflation: Mapping[str, float]
    converged: Mapping[str, bool]


@dataclass(slots=True, eq=False)
class _State:
    """What moves while the least squares runs."""

    machine: Machine
    world_from_base: Array
    world_from_cameras: dict[str, Array]
    known: Mapping[str, Known]
    free_base: bool
    depth_errors: dict[str, Array] = field(default_factory=dict)
    still: set[str] = field(default_factory=set)
    lengths: dict[str, float] = field(default_factory=dict)

    @property
    def free(self) -> list[str]:
        return [
            n for n in self.world_from_cameras if n not in self.known or self.known[n].covariance is not None
        ]


def fit(
    machine: Machine,
    views: Sequence[MachineViews],
    starts: Mapping[str, Array],
    known: Mapping[str, Known] | None = None,
    *,
    free_base: bool = False,
    model_sigma_m: float | None = None,
    done: Callable[[], None] = lambda: None,
) -> MachineFit:
    """Least squares from first poses to last ones.

    Args:
        machine: where its base is; with `free_base`, roughly.
        views: of all cameras.
        starts: first poses by camera, shape (4, 4).
        known: what is known of some cameras.
        free_base: whether the base is to be found too.
        model_sigma_m: how well the model fits the machine; None: `MODEL_SIGMA_M`.
        done: called after each step.

    Raises:
        CalibrationError: the base is free and no camera is known, so that nothing fixes the world.
    """
    known = dict(known or {})
    if free_base:
        require_world(known)
    state = _State(
        machine,
        machine.world_from_base,
        {v.camera.name: starts[v.camera.name] for v in views},
        known,
        free_base,
    )
    trust = TRUST if model_sigma_m is None else TRUST._replace(floor_m=model_sigma_m)
    sums: dict[str, SurfaceSums] = {}
    for step, widening_m, rounds in STAGES:
        thinner = [v.coarser(step if v.images.thinned.width >= 160 else 1) for v in views]
        state.still.clear()
        for number in range(rounds):
            _look(state, thinner, trust._replace(widening_m=widening_m), sums)
            _step(state, sums, 1.0 if number < HALF_AFTER else 0.5)
            done()
            if len(state.still) == len(views):
                break
    converged = {name: state.lengths[name] < RESTLESS for name in state.world_from_cameras}
    state.still.clear()
    _look(state, views, trust, sums)
    return _finish(state, sums, converged)


def require_world(known: Mapping[str, Known]) -> None:
    """Refuses to look for the base where no camera is known.

    Raises:
        CalibrationError: so that nothing fixes the world.
    """
    if not known:
        raise CalibrationError(
            "the machine's base and all cameras at once: nothing fixes the world; say which cameras' poses hold, or "
            "find the cameras by a board first"
        )


def _look(state: _State, views: Sequence[MachineViews], trust: Trust, sums: dict[str, SurfaceSums]) -> None:
    """Compares the images of all cameras that still move."""
    drawn = DrawnMachine(state.machine, state.world_from_base)
    moving = [v for v in views if v.camera.name not in state.still]

    def look(view: MachineViews) -> SurfaceSums:
        name = view.camera.name
        error = state.depth_errors.setdefault(name, np.zeros(2))
        return surface_sums(drawn, view, state.world_from_cameras[name], error, trust)

    results = spread(look, moving)
    for v, result in zip(moving, results, strict=True):
        sums[v.camera.name] = result


def _step(state: _State, sums: Mapping[str, SurfaceSums], share: float) -> None:
    """One step of Gauss and Newton for all cameras and the base, or a share of it."""
    normal, gradient = _equations(state, sums, dict.fromkeys(sums, 1.0))
    damped = normal + np.diag(np.tile(DAMPING, len(normal) // 6))
    twist = -share * np.linalg.solve(damped, gradient)
    parts = {name: twist[6 * row : 6 * row + 6] for row, name in enumerate(state.free)}
    base_twist = twist[-6:] if state.free_base else np.zeros(6)
    for name, own in sums.items():
        if name in state.still:
            continue
        here = state.world_from_cameras[name]
        part = parts.get(name, np.zeros(6))
        seen = part - adjoint(invert_rigid(here) @ state.world_from_base) @ base_twist
        equations = whole(own)
        state.depth_errors[name] = state.depth_errors[name] + share * depth_error_step(
            *equations, seen / share
        )
        state.world_from_cameras[name] = moved(here, part)
        state.lengths[name] = float(np.sqrt(np.maximum(seen @ of_pose(*equations)[0] @ seen, 0.0))) / share
        if not state.free_base and state.lengths[name] < STILL:
            state.still.add(name)
    if state.free_base:
        state.world_from_base = moved(state.world_from_base, base_twist)
        if np.sqrt(np.maximum(twist @ normal @ twist, 0.0)) < share * STILL:
            state.still.update(state.world_from_cameras)


def _equations(
    state: _State, sums: Mapping[str, SurfaceSums], inflation: Mapping[str, float]
) -> tuple[Array, Array]:
    """Normal equations of all unknowns: six per free camera, then six of the base.

    With A the adjoint of camera_from_base, a camera's images see its own twist minus A times the base's.
    """
    free = state.free
    size = 6 * (len(free) + state.free_base)
    normal, gradient = np.zeros((size, size)), np.zeros(size)
    for name, own in sums.items():
        part, slope = of_pose(*whole(own))
        part, slope = part / inflation[name], slope / inflation[name]
        here = state.world_from_cameras[name]
        if state.free_base:
            by_base = -adjoint(invert_rigid(here) @ state.world_from_base)
            normal[-6:, -6:] += by_base.T @ part @ by_base
            gradient[-6:] += by_base.T @ slope
        if name not in free:
            continue
        at = slice(6 * free.index(name), 6 * free.index(name) + 6)
        normal[at, at] += part
        gradient[at] += slope
        if state.free_base:
            normal[at, -6:] += part @ by_base
            normal[-6:, at] += by_base.T @ part
        if name in state.known:
            before, covariance = state.known[name]
            weight = np.linalg.inv(np.asarray(covariance))
            normal[at, at] += weight
            gradient[at] += weight @ between(before, here)
    return normal, gradient


def _finish(state: _State, sums: dict[str, SurfaceSums], converged: dict[str, bool]) -> MachineFit:
    inflation = {name: inflation_of(own) for name, own in sums.items()}
    normal, _ = _equations(state, sums, inflation)
    covariance = np.linalg.inv(normal + EASE * np.eye(len(normal)))
    return MachineFit(
        dict(state.world_from_cameras),
        state.world_from_base,
        {name: covariance[6 * r : 6 * r + 6, 6 * r : 6 * r + 6] for r, name in enumerate(state.free)},
        covariance[-6:, -6:] if state.free_base else None,
        sums,
        dict(state.depth_errors),
        inflation,
        converged,
    )


def inflation_of(sums: SurfaceSums) -> float:
    """By how much a camera's covariance must grow for the poses to agree with each other, at least 1.

    Noise of single pixels alone would leave the gradients of the poses as small as their normal equations say. What
    is wrong for a whole pose at once (a joint's sensor, the model's shape) leaves larger ones. The covariance that
    leaving out one pose after the other gives (jackknife) tells by how much; one number is taken of it, for a dozen
    poses do not say more.
    """
    everything, _ = whole(sums)
    changes = []
    for normal, gradient in zip(sums.normal, sums.gradient, strict=True):
        rest = everything - normal
        if normal.any() and np.linalg.cond(rest * _scale(rest)) < 1e12:
            changes.append(np.linalg.solve(rest, gradient))
    if len(changes) < 3:
        return 1.0
    spread_out = np.array(changes) - np.mean(changes, axis=0)
    jackknife = (len(changes) - 1) / len(changes) * spread_out.T @ spread_out
    by_images = np.trace(np.linalg.solve(everything + EASE * np.eye(8), sums.normal.sum(axis=0)))
    return max(1.0, float(np.trace(everything @ jackknife) / max(by_images, 1.0)))


def _scale(normal: Array) -> Array:
    """Brings a matrix's diagonal to one: its condition then does not depend on units."""
    root = 1 / np.sqrt(np.maximum(np.diag(normal), 1e-30))
    return np.outer(root, root)
