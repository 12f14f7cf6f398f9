"""Numbers of a site file that the field allows, and that are most likely not meant so: speeds, a machine's place."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.finding import Finding
from elbowroom.sensing.values.place import distance_m, unit_of_length
from elbowroom.site.machine_entry import JointEntry, MachineEntry
from elbowroom.site.paths import expand
from elbowroom.site.site import Site

SPEED, PLACE = "speed", "machine"
SAME = 0.02
"""Two numbers that differ by less, as a share, are the same number."""
SLOW_DEG_S, SHORT_S = 0.5, 0.005
FAR_M = 10.0
"""A machine whose base is farther from the grid most likely stands there by its unit."""


def look_at_site(site: Site) -> Iterator[Finding]:
    """What is said of joints and machine.

    Raises:
        SiteError, MachineError: a machine that is not usable.
    """
    limits = _urdf_speeds(site)
    for name, entry in site.entry.joints.items():
        yield from _speed(name, entry, limits.get(name))
    yield from _base(site)


def _speed(name: str, entry: JointEntry, urdf_rad_s: float | None) -> Iterator[Finding]:
    about, deg_s = (name,), entry.max_speed_deg_s
    if deg_s is not None and urdf_rad_s is not None and abs(deg_s - urdf_rad_s) <= SAME * urdf_rad_s:
        text = (
            f"joint {name}: max_speed_deg_s is {deg_s:g}, the number of the URDF, which is in radians a second: "
            "that is "
            f"{math.degrees(urdf_rad_s):.4g} degrees a second, and brakes over so much longer a way"
        )
        yield Finding(SPEED, about, text, stops=True)
    elif deg_s is not None and (deg_s < SLOW_DEG_S or _is_turns(deg_s)):
        text = (
            f"joint {name}: max_speed_deg_s is {deg_s:g}; if that is radians a second, write "
            f"{math.degrees(deg_s):.4g}: "
            "braking ways are too short otherwise"
        )
        yield Finding(SPEED, about, text, stops=False)
    if entry.braking_time_s < SHORT_S:
        text = f"joint {name}: braking_time_s is {entry.braking_time_s:g}, hardly any: check that it is in seconds"
        yield Finding(SPEED, about, text, stops=False)


def _is_turns(speed: float) -> bool:
    """Whether it is a half, one or two times pi, as data sheets say radians."""
    return any(abs(speed / (math.pi * share) - 1) < 0.003 for share in (0.5, 1.0, 2.0))


def _urdf_speeds(site: Site) -> Mapping[str, float]:
    """What URDFs say of turning joints' speeds [rad/s]; nothing where one cannot be read, which others say."""
    if not site.entry.joints:
        return {}
    alone = dict(_speeds_of(site, site.entry.machine)) if site.entry.machine is not None else {}
    return alone | {
        machine.joint_prefix + name: speed
        for machine in site.entry.machines
        for name, speed in _speeds_of(site, machine).items()
    }


def _speeds_of(site: Site, machine: MachineEntry) -> Mapping[str, float]:
    if machine.urdf is None:
        return {}
    try:
        root = ET.parse(expand(machine.urdf, site.path.parent)).getroot()
    except (OSError, ET.ParseError, SiteError):
        return {}
    speeds = {}
    for joint in root.iter("joint"):
        limit = joint.find("limit")
        if joint.get("type") in ("revolute", "continuous") and limit is not None:
            try:
                speed = float(limit.get("velocity", "0"))
            except ValueError:
                continue
            if speed > 0 and joint.get("name"):
                speeds[str(joint.get("name"))] = speed
    return speeds


def _base(site: Site) -> Iterator[Finding]:
    machine, entries = site.machine(), site.entry.machines
    if machine is None:
        return
    if site.entry.machine is not None and site.entry.machine.world_from_base is not None:
        yield from _far_base(site, machine.name, machine.world_from_base[:3, 3])
    for entry in entries:
        if entry.world_from_base is not None:
            yield from _far_base(site, entry.name, np.array(entry.world_from_base)[:3, 3])


def _far_base(site: Site, name: str, place: NDArray[np.float64]) -> Iterator[Finding]:
    """A base that stands metres away from the grid.

    Args:
        site: the file.
        name: of the machine.
        place: of its base, shape (3,) [m].
    """
    grid = site.grid()
    away = distance_m(grid, place)
    if away <= FAR_M:
        return
    unit = unit_of_length(grid, place)
    likely = (
        f"most likely world_from_base is in {unit}, and must be in metres"
        if unit
        else "check world_from_base"
    )
    text = f"machine {name}: its base stands {away:.4g} m from the grid; {likely}"
    yield Finding(PLACE, (name,), text, stops=bool(unit))
