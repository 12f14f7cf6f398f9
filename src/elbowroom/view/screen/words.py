"""Verdicts and times in the words and marks that a terminal shows."""

import math
from collections.abc import Mapping

from elbowroom.monitor import Condition, Health
from elbowroom.monitor.separation.margins import Margins
from elbowroom.motion import Cause, Level, Nearest, Verdict
from elbowroom.motion.motion import REACH_IN_BRAKING_DISTANCES

NOT_CERTIFIED = (
    "Not a certified safety function: it has no performance level (PL) and may only ever reduce motion."
)
"""What every summary and every screen must say (docs/safety.md)."""

MARKS: dict[Level, str] = {Level.STOP: "■", Level.DECELERATE: "▲", Level.INFORM: "●", Level.CLEAR: "○"}
"""A shape for each level, so that it does not hang on colour alone."""

LEVEL_WORDS: dict[Level, str] = {level: level.name for level in Level}

CAUSE_WORDS: dict[Cause, str] = {
    Cause.SURFACE: "surface",
    Cause.BLIND: "blind",
    Cause.OUTSIDE_GRID: "outside the grid",
    Cause.MACHINE: "itself",
    Cause.KEPT_OUT: "kept out",
    Cause.UNSEEN: "unseen",
    Cause.NONE: "",
    Cause.FAULT: "fault",
    Cause.STALE: "too old",
    Cause.INPUT: "input",
    Cause.WATCH: "watch",
    Cause.OFF_PATH: "off its path",
}


def travel_text(distance: float, unit: str) -> str:
    """A distance along a joint as people read it: "62 mm", "12 cm", "3.4°".

    It is rounded down: what is shown is never more than what is free.

    Args:
        distance: [m], [rad], or of a path whose joints are of both kinds [m or rad].
        unit: "m", "rad", or anything else, which is shown with the plain number.
    """
    if unit == "m":
        millimetres = math.floor(distance * 1e3 + 1e-6)
        return f"{millimetres} mm" if millimetres < 1000 else f"{millimetres // 10} cm"
    if unit == "rad":
        return f"{math.floor(math.degrees(distance) * 10 + 1e-6) / 10:.1f}°"
    return f"{math.floor(distance * 1e3 + 1e-6) / 1e3:.3f} {unit}"


def place_text(verdict: Verdict) -> str:
    """Where the link meets what: "detector at 0.31, -0.20, 1.05 m"; empty where nothing is met."""
    if verdict.place_in_world is None:
        return verdict.link or ""
    x, y, z = verdict.place_in_world
    link = verdict.link if verdict.other_link is None else f"{verdict.link} and {verdict.other_link}"
    return f"{link} at {x:.2f}, {y:.2f}, {z:.2f} m"


def cause_text(verdict: Verdict) -> str:
    """What ends the travel, and of a stop by unseen space how far an operator may creep: "unseen, creep 41 mm"."""
    word, creep = CAUSE_WORDS[verdict.cause], verdict.creep
    if creep is None or creep.travel <= 0:
        return word
    return f"{word}, creep {travel_text(creep.travel, verdict.free_travel_unit)}"


def travel_bar(verdict: Verdict, width: int = 20) -> tuple[str, str]:
    """Free travel as a bar of which a fifth is one braking distance: the filled part and the rest.

    In the rest, a stroke marks where S and M end; the end of the bar is L.

    Args:
        verdict: whose travel to show.
        width: of the whole bar [characters].
    """
    whole = REACH_IN_BRAKING_DISTANCES * verdict.motion.braking_distance
    filled = min(width, math.floor(verdict.free_travel / whole * width + 1e-6))
    marks = {round(width / 5) - 1, round(2 * width / 5) - 1}
    return "█" * filled, "".join("│" if i in marks else "·" for i in range(filled, width))


def place_first(verdict: Verdict) -> str:
    """As `place_text` for narrow screens: "0.31 -0.20 1.05 detector"; what is cut off is never a number."""
    if verdict.place_in_world is None:
        return verdict.link or ""
    x, y, z = verdict.place_in_world
    return f"{x:.2f} {y:.2f} {z:.2f} {verdict.link}"


def margins_text(margins: Margins) -> str:
    """How far the machine is from what it may hit, in one line.

    "nearest seen 12 cm (detector), unseen 41 mm (sleeve); left before what stands -0.38 m, before a person out of
    unseen space -2.11 m (T_r 212 ms)"
    """
    near = margins.distances
    nearest = f"nearest seen {_nearest_text(near.seen)}, unseen {_nearest_text(near.unseen)}"
    standing, person, reaction_s = margins.least_standing_m, margins.least_person_m, margins.reaction_s
    if standing is None or person is None or reaction_s is None:
        return nearest
    return (
        f"{nearest}; left before what stands {standing:.2f} m, before a person out of unseen space {person:.2f} m "
        f"(T_r {1e3 * reaction_s:.0f} ms)"
    )


def _nearest_text(nearest: Nearest | None) -> str:
    if nearest is None:
        return "-"
    if not nearest.is_there:
        return f"none within {travel_text(nearest.distance_m, 'm')}"
    of = f"{nearest.link}, outside the grid" if nearest.is_outside else nearest.link
    return f"{travel_text(nearest.distance_m, 'm')} ({of})"


def shares_text(shares: Mapping[str, float]) -> str:
    """What a pass without motions came to: "free 61.2 %, surface 9.8 %, unseen 29.0 % (blind 0.4 %, own body 1.2 %)".

    Args:
        shares: of all voxels, as of `monitor.rows.shares_pct` [%].
    """
    return (
        f"free {shares['free_pct']:.1f} %, surface {shares['surface_pct']:.1f} %, unseen {shares['unseen_pct']:.1f} % "
        f"(blind {shares['blind_pct']:.1f} %, own body {shares['body_pct']:.1f} %)"
    )


def plain_line(verdict: Verdict) -> str:
    """One verdict in a few plain words: "larm + STOP 3.1° (surface, detector)"."""
    line = f"{verdict.motion.name} {LEVEL_WORDS[verdict.level]}"
    if verdict.level is Level.CLEAR:
        return f"{line} (leads away)" if verdict.escapes else line
    why = ", ".join(word for word in (cause_text(verdict), verdict.link) if word)
    return f"{line} {travel_text(verdict.free_travel, verdict.free_travel_unit)}" + (
        f" ({why})" if why else ""
    )


def counts_text(levels: list[Level]) -> str:
    """How many motions are at which level: "1 STOP, 7 CLEAR"."""
    return ", ".join(f"{levels.count(level)} {LEVEL_WORDS[level]}" for level in Level if level in levels)


def health_text(health: Health | None) -> str:
    """How cameras and machine are, in one line.

    "watch: 20 of 21 cameras stand still, 1 hidden (cam03 83 %); most off: cam07 by 0.02°, 1 mm; machine off by 2 mm
    (c_arc)"
    """
    if health is None:
        return "watch: none, a camera that is knocked goes unnoticed"
    others = [c for c in Condition if c is not Condition.STILL and health.count(c)]
    parts = [f"{health.count(Condition.STILL)} of {len(health.cameras)} cameras stand still"]
    parts += [_condition_text(health, condition) for condition in others]
    text = "watch: " + ", ".join(parts)
    worst = health.worst
    if worst is not None and worst.shift is not None:
        text += f"; most off: {worst.camera} by {worst.shift.turn_deg:.2f}°, {worst.shift.move_mm:.0f} mm"
    told = [link for link in health.links if link.is_off is not None and len(link.cameras) > 2]
    if told:
        link = max(told, key=lambda link: link.off_m)
        text += f"; machine off by {link.off_m * 1e3:.0f} mm ({link.link})"
    return text


def _condition_text(health: Health, condition: Condition) -> str:
    """How many cameras are in a condition; which, and how much of their view is hidden, where it is hidden or gone."""
    text = f"{health.count(condition)} {condition.name.lower()}"
    if condition in (Condition.UNSURE, Condition.MOVED, Condition.CHANGED):
        return text
    those = [camera for camera in health.cameras if camera.condition is condition]
    if condition is Condition.SILENT:
        return f"{text} ({', '.join(camera.camera for camera in those)})"
    return f"{text} ({', '.join(f'{camera.camera} {100 * camera.share_hidden:.0f} %' for camera in those)})"
