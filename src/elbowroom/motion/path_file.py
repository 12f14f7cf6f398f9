"""A path from a file: a table of times and joint positions, or a ROS JointTrajectory as YAML or JSON."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from elbowroom.errors import JointsError, SiteError
from elbowroom.files.yaml_file import read_yaml
from elbowroom.motion.trajectory import Trajectory

MAX_BYTES = 50_000_000
"""No larger table is read."""
TIMES = {"time_s": 1.0, "time_ms": 1e-3, "time_us": 1e-6, "time_ns": 1e-9}
"""Names that the column of times may have, and the seconds of its unit."""
VELOCITY = "_velocity"
"""Ends the name of a joint's column of velocities."""


def read_path(path: str | Path) -> Trajectory:
    """The path that a file holds.

    CSV (`.csv`): a header `time_s,<joint>,...`, perhaps with `<joint>_velocity` for each joint; [m, rad, a second].
    YAML or JSON (`.yaml`, `.yml`, `.json`): `joint_names`, and `points` with `positions`, perhaps `velocities`, and
    `time_s` or `time_from_start`, as messages trajectory_msgs/JointTrajectory are written.

    Args:
        path: of the file.

    Raises:
        JointsError: a file that is missing, too large, or holds no such path; names the file and the line or the point.
    """
    path = Path(path)
    if not path.is_file():
        raise JointsError(f"{path}: no such file; expected a path, as CSV with a header time_s,<joint>,...")
    if path.suffix.lower() in (".yaml", ".yml", ".json"):
        return _blamed(path, lambda: _of_message(path))
    if path.suffix.lower() != ".csv":
        raise JointsError(f"{path}: a path is .csv, .yaml or .json, not {path.suffix or 'without an ending'}")
    if path.stat().st_size > MAX_BYTES:
        raise JointsError(f"{path}: {path.stat().st_size:,} bytes, at most {MAX_BYTES:,} are read")
    return _blamed(path, lambda: _of_table(path.read_text(encoding="utf-8-sig")))


def _blamed(path: Path, make: Any) -> Trajectory:
    """What `make` returns; its errors name the file."""
    try:
        made: Trajectory = make()
        return made
    except (csv.Error, UnicodeDecodeError) as error:
        raise JointsError(f"{path}: not a CSV file in UTF-8 ({error})") from None
    except SiteError as error:
        raise JointsError(str(error)) from None
    except JointsError as error:
        raise JointsError(f"{path}: {error}") from None


def _of_table(text: str) -> Trajectory:
    """Of a table with a header."""
    reader = csv.reader(io.StringIO(text, newline=""))
    header = [name.strip() for name in next(reader, [])]
    times = [name for name in header if name in TIMES]
    if len(times) != 1 or len(set(header)) != len(header) or not all(header):
        raise JointsError(
            f"line 1: header is {','.join(header)[:80]!r}, must be time_s,<joint>,... with one column of times "
            f"({', '.join(TIMES)}), each name once"
        )
    speeds = [name for name in header if name.endswith(VELOCITY) and name.removesuffix(VELOCITY) in header]
    names = [name for name in header if name not in (*times, *speeds)]
    if not names:
        raise JointsError("line 1: no joint beside the times")
    if speeds and len(speeds) != len(names):
        lacking = next(name for name in names if name + VELOCITY not in speeds)
        raise JointsError(f"line 1: joint {lacking} has no column {lacking}{VELOCITY}, and others have")
    rows = [_row(row, header, reader.line_num) for row in reader if row]
    if not rows:
        raise JointsError("no rows below the header, at least one is needed")
    return Trajectory(
        names,
        [row[times[0]] * TIMES[times[0]] for row in rows],
        [[row[name] for name in names] for row in rows],
        [[row[name + VELOCITY] for name in names] for row in rows] if speeds else None,
    )


def _row(row: list[str], header: list[str], line: int) -> dict[str, float]:
    if len(row) != len(header):
        raise JointsError(f"line {line}: {len(row)} values, the header names {len(header)} columns")
    found = {}
    for name, text in zip(header, row, strict=True):
        try:
            found[name] = float(text)
        except ValueError:
            raise JointsError(f"line {line}: {name} is {text[:40]!r}, must be a number") from None
    return found


def _of_message(path: Path) -> Trajectory:
    """Of a mapping, which may hold a message under the key `trajectory` or `joint_trajectory`."""
    said: Any = read_yaml(path)
    for key in ("trajectory", "joint_trajectory"):
        said = said[key] if isinstance(said, Mapping) and isinstance(said.get(key), Mapping) else said
    names, points = said.get("joint_names"), said.get("points")
    if not (isinstance(names, list) and names and all(isinstance(name, str) for name in names)):
        raise JointsError("joint_names: must be a list of names")
    if not (isinstance(points, list) and points and all(isinstance(point, Mapping) for point in points)):
        raise JointsError("points: must be a list of mappings, at least one")
    told = [_numbers(point, "velocities", n, len(names)) for n, point in enumerate(points)]
    if any(told) and not all(told):
        raise JointsError(f"point {told.index(None)}: no velocities, and others have some")
    positions = [_numbers(point, "positions", n, len(names)) for n, point in enumerate(points)]
    if None in positions:
        raise JointsError(f"point {positions.index(None)}: positions: missing")
    times = [_time(point, n) for n, point in enumerate(points)]
    return Trajectory(names, times, positions, told if all(told) else None)  # type: ignore[arg-type]


def _numbers(point: Mapping[str, Any], key: str, n: int, count: int) -> list[float] | None:
    """A list of a point; None: it has none, or an empty one."""
    values = point.get(key)
    if values is None or values == []:
        return None
    if not (isinstance(values, list) and len(values) == count and all(map(_is_number, values))):
        raise JointsError(f"point {n}: {key}: must be {count} numbers, one for each joint")
    return [float(value) for value in values]


def _time(point: Mapping[str, Any], n: int) -> float:
    """When a point is reached [s]."""
    if "time_s" in point and _is_number(point["time_s"]):
        return float(point["time_s"])
    since: Any = point.get("time_from_start")
    if _is_number(since):
        return float(since)
    if isinstance(since, Mapping):
        for whole, part in (("sec", "nanosec"), ("secs", "nsecs")):
            if _is_number(since.get(whole)) and _is_number(since.get(part)):
                return float(since[whole]) + float(since[part]) / 1e9
    raise JointsError(
        f"point {n}: no time; write time_s, or time_from_start as seconds or {{sec: 1, nanosec: 500000000}}"
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
