"""A person of capsules and ellipsoids who walks along a closed path."""

from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from elbowroom.simulate.shapes import Shape, capsule, ellipsoid, join
from elbowroom.simulate.solid import Mesh, Solid

GAIT_PHASES = 16
"""A stride is shown in this many shapes, so that each can keep its ray-casting scene."""
STRIDE_M = 1.1
"""Length of a stride of two steps: people in an intervention room do not run [m]."""


@dataclass(frozen=True, slots=True)
class Stance:
    """Where a person is and how far into a stride.

    Args:
        x_m, y_m: place on the floor, world frame [m].
        heading_rad: direction of view, about z from the x axis [rad].
        phase: stride, a turn is one stride [rad].
    """

    x_m: float
    y_m: float
    heading_rad: float
    phase: float = 0.0


class Way(Protocol):
    """A closed path that somebody walks round and round."""

    @property
    def period_s(self) -> float:
        """Time of one round [s]."""

    def at(self, time_s: float) -> Stance:
        """Where the walker is at a time [s]."""


@dataclass(frozen=True, slots=True)
class Walk:
    """A closed path: an ellipse that is walked round once a period, slower at its start than opposite to it.

    Args:
        centre_m: middle of the ellipse (x, y), world frame [m].
        radii_m: half axes along x and y [m].
        period_s: time of one round [s].
        start_rad: where on the ellipse the round starts [rad].
        direction: +1 counter-clockwise seen from above, -1 clockwise.
    """

    centre_m: tuple[float, float]
    radii_m: tuple[float, float]
    period_s: float
    start_rad: float = 0.0
    direction: int = 1

    def at(self, time_s: float) -> Stance:
        """Where the walker is at a time [s]."""
        turn = 2 * np.pi * time_s / self.period_s
        done = turn - 0.8 * np.sin(turn)
        angle = self.start_rad + self.direction * done
        (cx, cy), (a, b) = self.centre_m, self.radii_m
        vx, vy = -self.direction * a * np.sin(angle), self.direction * b * np.cos(angle)
        walked_m = done * np.hypot(a, b) / np.sqrt(2)
        return Stance(
            x_m=float(cx + a * np.cos(angle)),
            y_m=float(cy + b * np.sin(angle)),
            heading_rad=float(np.arctan2(vy, vx)),
            phase=float(2 * np.pi * walked_m / STRIDE_M),
        )


@dataclass(frozen=True, slots=True)
class Person:
    """One of the staff.

    Args:
        name: such as "doctor".
        walk: the path.
        height_m: body height [m].
        elbow_rad: how far the elbows are bent: 0.3 hangs, 1.4 holds the hands at work before the body [rad].
        phases: a stride is shown in so many shapes; with few, hands and feet jump from one to the next.
    """

    name: str
    walk: Way
    height_m: float = 1.75
    elbow_rad: float = 0.3
    phases: int = GAIT_PHASES

    def solids(self, stance: Stance) -> tuple[Solid, ...]:
        """Body and hair at a stance."""
        phase = round(stance.phase / (2 * np.pi) * self.phases) % self.phases
        c, s = np.cos(stance.heading_rad), np.sin(stance.heading_rad)
        world_from_person = np.array(
            [[c, -s, 0, stance.x_m], [s, c, 0, stance.y_m], [0, 0, 1, 0], [0, 0, 0, 1.0]]
        )
        return (
            Solid(self.name, _body(self.height_m, self.elbow_rad, phase, self.phases), world_from_person),
            Solid(f"{self.name} hair", _hair(self.height_m), world_from_person, is_dark=True),
        )


@cache
def _hair(height_m: float) -> Mesh:
    return join([_scaled(ellipsoid((-0.015, 0, 1.66), (0.105, 0.088, 0.095)), height_m)])


@cache
def _body(height_m: float, elbow_rad: float, phase: int, phases: int) -> Mesh:
    """A body of 1.75 m at rest, scaled: x forward, y left, feet on z = 0."""
    swing = np.sin(2 * np.pi * phase / phases)
    lift = np.cos(2 * np.pi * phase / phases)
    parts = [
        capsule((0, 0, 0.98), (0, 0, 1.28), 0.18, squeeze=0.65, columns=12),
        ellipsoid((0, 0, 1.40), (0.10, 0.21, 0.09)),
        ellipsoid((0, 0, 0.92), (0.12, 0.17, 0.13)),
        capsule((0, 0, 1.42), (0.01, 0, 1.56), 0.055),
        ellipsoid((0.01, 0, 1.62), (0.095, 0.075, 0.125), rows=8),
    ]
    for side in (1, -1):
        parts += _leg(side, 0.42 * side * swing, 0.15 + 0.55 * max(0.0, side * lift))
        parts += _arm(side, -0.40 * side * swing, elbow_rad)
    return join([_scaled(part, height_m) for part in parts])


def _leg(side: int, hip_rad: float, knee_rad: float) -> list[Shape]:
    hip = np.array([0.0, 0.09 * side, 0.90])
    knee = hip + 0.41 * _down(hip_rad)
    ankle = knee + 0.40 * _down(hip_rad - knee_rad)
    return [
        capsule(hip, knee, 0.075),
        capsule(knee, ankle, 0.055),
        ellipsoid(ankle + np.array([0.06, 0, -0.02]), (0.13, 0.045, 0.05)),
    ]


def _arm(side: int, shoulder_rad: float, elbow_rad: float) -> list[Shape]:
    shoulder = np.array([0.0, 0.21 * side, 1.40])
    elbow = shoulder + 0.28 * _down(shoulder_rad) + (0, 0.03 * side, 0)
    wrist = elbow + 0.25 * _down(shoulder_rad + elbow_rad)
    return [
        capsule(shoulder, elbow, 0.05),
        capsule(elbow, wrist, 0.04),
        ellipsoid(wrist + 0.07 * _down(shoulder_rad + elbow_rad), (0.05, 0.03, 0.075)),
    ]


def _down(angle_rad: float) -> NDArray[np.float64]:
    """Straight down, swung forward by an angle about the y axis."""
    return np.array([np.sin(angle_rad), 0.0, -np.cos(angle_rad)])


def _scaled(part: Shape, height_m: float) -> Shape:
    vertices, faces = part
    return vertices * (height_m / 1.75), faces
