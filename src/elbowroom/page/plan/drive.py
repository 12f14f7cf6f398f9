"""A joint driven through its range in the planned room, step by step, until it would stop."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.errors import InputError
from elbowroom.motion import Level, Motion, Verdict, check_motion
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.stale import Stop, never, unless
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.reconstruct import free_space_of
from elbowroom.sensing import Snapshot
from elbowroom.simulate import render

STEPS = 40
"""Of the joint's range."""
DRIVEN_PX = 160
"""Images of so many pixels across are simulated at each step."""
TURN_RAD = 3.14159
"""A joint without limits is driven so far each way [rad, or m]."""


@dataclass(frozen=True, slots=True)
class Step:
    """Where the joint is, and what it would be told there.

    Args:
        position: of the joint [m or rad].
        verdict: of its going on.
        is_last: it stops there, or has come to its limit.
    """

    position: float
    verdict: Verdict
    is_last: bool

    @property
    def stops(self) -> bool:
        """Whether it stops there, and not at its limit."""
        return self.verdict.level is Level.STOP


def driven(
    ground: Ground, layout: Layout, joint: str, direction: int, is_stale: Stop = never
) -> Iterator[Step]:
    """Drives a joint from where it stands; at each step all cameras look anew, as they would.

    Args:
        ground: the room; its motions say how far the joint brakes.
        layout: where everything is.
        joint: which.
        direction: +1 or -1.
        is_stale: asked before each step.

    Raises:
        InputError: no machine, no cameras, no such joint, or no speed of it.
        Stale: nobody wants to know any more.
    """
    machine, motion = ground.machine, _motion(ground, joint, direction)
    if machine is None or not layout.cameras:
        raise InputError("plan: no camera, or no machine that could be driven")
    of = machine.joint(motion.joint)
    low, high = max(of.lower, -TURN_RAD), min(of.upper, TURN_RAD)
    step, here = (high - low) / STEPS, float(layout.joints[of.name])
    end = high if direction > 0 else low
    fixed = ground.fixed_with(layout)
    cameras = [with_joined_pixels(placed.camera, DRIVEN_PX) for placed in layout.cameras]
    while True:
        unless(is_stale)
        now = replace(layout, joints={**layout.joints, of.name: here})
        moment = ground.moment_of(now, fixed)
        snapshot = Snapshot(tuple(render(cameras, moment, seed=1)), moment.joints, now_ns=moment.stamp_ns)
        space = free_space_of(ground.grid, cameras, snapshot, machine, ground.terms)
        verdict = check_motion(space, machine, moment.joints, motion)
        at_end = abs(end - here) < 1e-3 * step
        yield Step(here, verdict, verdict.level is Level.STOP or at_end)
        if verdict.level is Level.STOP or at_end:
            return
        here = float(np.clip(here + direction * min(step, max(verdict.free_travel, 1e-3)), low, high))


def _motion(ground: Ground, joint: str, direction: int) -> Motion:
    """The site's motion of a joint.

    Raises:
        InputError: no machine, no such joint, or no speed of it.
    """
    if ground.machine is None:
        raise InputError("plan: the site has no machine")
    name = ground.machine.joint(joint).name
    for motion in ground.site.motions(ground.machine):
        if motion.joint == name and motion.direction == direction:
            return motion
    raise InputError(f"plan: joint {name} has no speed in the site file, so nobody knows how it brakes")
