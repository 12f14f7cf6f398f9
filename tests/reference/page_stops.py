"""Twenty stops of different causes, as a run's passes: each with what a person has to read from the page."""

from dataclasses import replace

import numpy as np

from elbowroom.finding import Finding
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor import CycleResult, Decision, Pass
from elbowroom.monitor.gate.state import Allowed, Phase
from elbowroom.monitor.health.health import Health
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.motion import Cause, Creep, Level, Motion, PathVerdict, Trajectory, Verdict
from elbowroom.motion.path import Blocked
from elbowroom.sensing import DepthFrame, Snapshot

STEP_NS = 100_000_000
PLACE = (0.31, -0.2, 1.05)
CAMERAS = [f"cam{number:02d}" for number in range(5)]


def clear(number: int, motions: tuple[Motion, ...]) -> Pass:
    """A pass in which all is clear.

    Args:
        number: of the pass.
        motions: of the room.
    """
    image = np.full((36, 48), 1.0 + number / 1000, np.float32)
    frames = tuple(DepthFrame(name, number * STEP_NS, image) for name in CAMERAS)
    unit = {"long": "m"}
    verdicts = tuple(
        Verdict(m, Level.CLEAR, m.looked_at, unit.get(m.joint, "rad"), None, None, Cause.NONE)
        for m in motions
    )
    result = CycleResult(number, number * STEP_NS, None, verdicts, {"carve": 1.0}, 0.0, given=tuple(CAMERAS))
    return Pass(Snapshot(frames, {"long": 0.1, "larm": 0.0}, now_ns=number * STEP_NS), result, 0.0)


def stops(motions: tuple[Motion, ...]) -> list[tuple[str, Pass, tuple[str, ...]]]:
    """Of each stop its name, the pass, and what the page has to say of it (pieces of English text).

    Args:
        motions: of the room: long +, long -, larm +, larm -.
    """
    found = []

    def add(name: str, due: tuple[str, ...], one: Pass) -> None:
        found.append((name, one, due))

    def blocked(cause: Cause, motion: int = 0, **more) -> Pass:
        done = clear(2 * len(found) + 1, motions)
        verdict = done.result.verdicts[motion]
        stopped = replace(
            verdict,
            level=Level.STOP,
            free_travel=0.4 * verdict.motion.braking_distance,
            link="detector",
            place_in_world=PLACE,
            cause=cause,
            **more,
        )
        rows = (*done.result.verdicts[:motion], stopped, *done.result.verdicts[motion + 1 :])
        return replace(done, result=replace(done.result, verdicts=rows))

    def everything(cause: Cause, **more) -> Pass:
        done = clear(2 * len(found) + 1, motions)
        rows = tuple(Verdict.stop(v.motion, v.free_travel_unit, cause) for v in done.result.verdicts)
        return replace(done, result=replace(done.result, verdicts=rows, **more))

    def sick(cause: HealthCause, source: str, text: str, clears: str) -> Pass:
        return everything(Cause.INPUT, sick=(Sick(cause, source, text, clears),))

    def latched(reason: Reason, subject: str, text: str) -> Pass:
        fault = Fault(reason, subject, text)
        allowed = (Allowed("long +", Level.STOP, 0.0, reason),)
        done = clear(2 * len(found) + 1, motions)
        return replace(done, decision=Decision(Phase.LATCHED, allowed, (fault,), (fault,)))

    add("surface", ("long + stops", "detector", "something that cameras see"), blocked(Cause.SURFACE))
    add("unseen", ("larm - stops", "detector", "nobody sees", "x 0.31"), blocked(Cause.UNSEEN, 3))
    creep = Creep(0.02, 0.001, 0.041, Cause.NONE)
    add("creep", ("nobody sees", "creep 41 mm", "20 mm/s"), blocked(Cause.UNSEEN, creep=creep))
    add("blind", ("long -", "delivers nothing valid"), blocked(Cause.BLIND, 1))
    add("outside", ("leave the watched space", "unchecked_links"), blocked(Cause.OUTSIDE_GRID, 2))
    add("itself", ("detector meets l_arm", "allowed_contacts"), blocked(Cause.MACHINE, 2, other_link="l_arm"))
    add("zone", ("zone anaesthesia", "site file"), blocked(Cause.KEPT_OUT, zone="anaesthesia"))
    add("fault", ("program failed", "KeyError: 'cam07'"), everything(Cause.FAULT, fault="KeyError: 'cam07'"))
    late = "the oldest image is 260 ms old when the verdicts are out, at most 200 ms are allowed"
    add("late", ("too old by now", "260 ms", "Newer images"), everything(Cause.STALE, late=late))
    finding = Finding("unit", ("cam02",), "cam02: depths look like millimetres", True)
    add("unit", ("cannot be right", "cam02", "millimetres"), everything(Cause.INPUT, findings=(finding,)))
    text = "joints: no value for 0.4 s"
    add(
        "joints gone",
        ("cannot be right", text),
        sick(HealthCause.JOINTS_MISSING, "joints", text, "they come again"),
    )
    text = "larm stands still to the last bit while the images show it move"
    frozen = sick(HealthCause.JOINTS_FROZEN, "joints", text, "it changes for 1 s")
    add("joints frozen", (text, "It ends when it changes for 1 s"), frozen)
    text = "long is 0.12 m beyond its limit"
    add("joints beyond", (text,), sick(HealthCause.JOINTS_BEYOND, "joints", text, "it is within them"))
    text = "larm jumped by 14 degrees in 10 ms"
    add("joints jump", (text,), sick(HealthCause.JOINTS_IMPLAUSIBLE, "joints", text, "they move as they can"))
    moved = Health((), (), {"cam03": "cam03 has moved by 1.2 degrees"})
    add("moved", ("cam03 has moved", "commission again"), everything(Cause.WATCH, health=moved))
    off = Health((), (), {"machine": "link c_arc is 31 mm from where the joints say"})
    add("machine off", ("c_arc is 31 mm", "not where it should be"), everything(Cause.WATCH, health=off))
    nothing = "no camera gives anything that counts"
    add("all blind", (nothing,), everything(Cause.BLIND, blind="all 5 cameras are left out"))
    text = "cam01 gives no image for 1.4 s"
    add("latched camera", ("gate holds", text), latched(Reason.CAMERA_DISCONNECTED, "cam01", text))
    add("latched age", ("gate holds", "too old"), latched(Reason.STALE, "", "images were too old"))
    add(
        "cannot rest",
        ("would not rest", "source meets space that nobody sees"),
        _moving(blocked(Cause.UNSEEN)),
    )
    return found


def _moving(done: Pass) -> Pass:
    """A pass of a machine that is too fast."""
    path = Trajectory(["long"], [0.0, 0.3], [[0.1], [0.12]])
    met = Blocked(0.1, Cause.UNSEEN, "source", PLACE)
    verdict = PathVerdict(path, Level.STOP, met, None, None, None, 0.3)
    return replace(done, result=replace(done.result, stopping=verdict))
