"""A machine's joint positions over time, perhaps with velocities, to be asked at each frame's time of exposure."""

import csv
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import JointsError

END_SLACK_NS = 1_000_000
"""A record answers up to 1 ms beyond its ends with its first or last row; farther out it knows nothing."""
MAX_CSV_BYTES = 1_000_000_000
VELOCITY = "_velocity"
"""Ends the name of the column that holds a joint's velocity."""
STAMP_COLUMN = "stamp_ns"
STAMP_COLUMNS = {"stamp_ns": 1, "stamp_us": 1_000, "stamp_ms": 1_000_000, "stamp_s": 1_000_000_000}
"""Names that the column of times may have, and the nanoseconds of its unit."""
SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars"}
"""What other programs part columns by, in words."""
LIKE_TIMES = (
    "time",
    "times",
    "timestamp",
    "stamp",
    "t",
    "secs",
    "epoch",
    "header.stamp",
    "header.stamp.secs",
)
"""Names of a column of times that does not say its unit."""


@dataclass(frozen=True, slots=True, eq=False)
class JointRecord:
    """Joint positions at rising times.

    Args:
        stamps_ns: times [ns, the clock of the frames], shape (n,), whole numbers, strictly increasing, n at
            least 1.
        positions: per joint its positions [m or rad], shape (n,).
        max_gap_ns: rows farther apart than this have nothing known between them; None: any two rows are
            joined.
        velocities: per joint its velocities [m/s or rad/s], shape (n,); of joints that are missing they are not known.
        received_ns: when each row had come [ns, the recorder's clock], shape (n,); None: at its own time.

    Raises:
        JointsError: no rows, no joints, lengths that differ, stamps that do not rise, numbers that are not
            finite.
    """

    stamps_ns: NDArray[np.int64]
    positions: Mapping[str, NDArray[np.float64]]
    max_gap_ns: int | None = None
    velocities: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    received_ns: NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        stamps = np.array(self.stamps_ns)
        if stamps.ndim != 1 or stamps.size == 0 or stamps.dtype.kind not in "iu":
            raise JointsError(
                f"joint record: stamps_ns must be whole nanoseconds in one row of at least one, got "
                f"{stamps.dtype} {stamps.shape}"
            )
        stamps = stamps.astype(np.int64)
        if (np.diff(stamps) <= 0).any():
            row = int(np.argmax(np.diff(stamps) <= 0)) + 1
            raise JointsError(
                f"joint record: stamps_ns[{row}] is {stamps[row]} after {stamps[row - 1]}; "
                "stamps must strictly rise"
            )
        if not self.positions:
            raise JointsError("joint record: no joints; at least one is needed")
        stamps.setflags(write=False)
        object.__setattr__(self, "stamps_ns", stamps)
        if self.received_ns is not None:
            received = np.array(self.received_ns, dtype=np.int64)
            if received.shape != stamps.shape:
                raise JointsError(
                    f"joint record: received_ns has shape {received.shape}, its stamps have {stamps.shape}"
                )
            received.setflags(write=False)
            object.__setattr__(self, "received_ns", received)
        for name in ("positions", "velocities"):
            object.__setattr__(self, name, _columns(getattr(self, name), stamps.shape))

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the record."""
        return tuple(self.positions)

    def at(self, stamp_ns: int) -> dict[str, float]:
        """The joint positions at a time, straight between the two rows around it.

        A continuous joint is not unwound: rows on both sides of a full turn are joined through zero. But for a base
        that moves, `<name>/yaw`, with `<name>/pitch` and `<name>/roll` or without: that turns the shortest way.

        Args:
            stamp_ns: time [ns].

        Returns:
            Position by joint [m or rad].

        Raises:
            JointsError: the time lies more than `END_SLACK_NS` outside the record, or in a gap above
                `max_gap_ns`: where the machine was is not known then, and is not invented.
        """
        stamps = self.stamps_ns
        first, last = int(stamps[0]), int(stamps[-1])
        if not first - END_SLACK_NS <= stamp_ns <= last + END_SLACK_NS:
            raise JointsError(
                f"joints at {stamp_ns} ns: not known, the record spans {first} to {last} ns; "
                "record the joints for as long as the frames"
            )
        clamped = min(max(stamp_ns, first), last)
        after = int(np.searchsorted(stamps, clamped))
        if stamps[after] == clamped:
            return {joint: float(values[after]) for joint, values in self.positions.items()}
        before = after - 1
        gap = int(stamps[after]) - int(stamps[before])
        if self.max_gap_ns is not None and gap > self.max_gap_ns:
            raise JointsError(
                f"joints at {stamp_ns} ns: not known, the record has a gap of {gap / 1e6:g} ms there, "
                f"at most {self.max_gap_ns / 1e6:g} ms are bridged"
            )
        # the differences are exact in whole nanoseconds; only their ratio is a float
        share = (clamped - int(stamps[before])) / gap
        found = {
            joint: float(values[before] + share * (values[after] - values[before]))
            for joint, values in self.positions.items()
        }
        for yaw in self.positions:
            if yaw.endswith("/yaw"):
                found |= self._turned(yaw, before, share)
        return found

    def knows(self, stamp_ns: int) -> bool:
        """Whether `at` has an answer.

        Args:
            stamp_ns: time [ns].
        """
        try:
            self.at(stamp_ns)
        except JointsError:
            return False
        return True

    def velocities_at(self, stamp_ns: int) -> dict[str, float]:
        """How fast joints were at a time, straight between the two rows around it, of those of which it is known.

        Args:
            stamp_ns: time [ns], one at which `at` knows the positions.

        Returns:
            Velocity by joint [m/s or rad/s].
        """
        since = self.stamps_ns - self.stamps_ns[0]
        asked = stamp_ns - int(self.stamps_ns[0])
        return {joint: float(np.interp(asked, since, values)) for joint, values in self.velocities.items()}

    def _turned(self, yaw: str, before: int, share: float) -> dict[str, float]:
        """The angles of a base at a share of the way between two rows, the shortest way."""
        angles = [yaw, *(yaw.replace("/yaw", f"/{angle}") for angle in ("pitch", "roll"))]
        if not all(angle in self.positions for angle in angles):
            start, end = self.positions[yaw][before : before + 2]
            return {yaw: float(start + share * ((end - start + np.pi) % (2 * np.pi) - np.pi))}
        from scipy.spatial.transform import Rotation, Slerp  # slow to load, and few machines need it

        rows = np.stack([self.positions[angle][before : before + 2] for angle in angles], axis=1)
        between = Slerp([0.0, 1.0], Rotation.from_euler("ZYX", rows))(share)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # nose up or down: one of the answers will do
            return dict(zip(angles, between.as_euler("ZYX").tolist(), strict=True))

    @classmethod
    def from_csv(cls, path: str | Path, max_gap_ns: int | None = None) -> "JointRecord":
        """From a file with a header `stamp_ns,<joint>,...` and a row per time.

        A column `<joint>_velocity` beside that of a joint holds its velocity.
        Times may be any column, also `stamp_us`, `stamp_ms` or `stamp_s`, whose numbers may have a decimal point.

        Args:
            path: a CSV file, UTF-8, comma-separated.
            max_gap_ns: as of the class.

        Raises:
            JointsError: the file is missing, is no such file, or has a row that is not usable; names file and
                line.
        """
        path = Path(path)
        if not path.is_file():
            raise JointsError(
                f"{path}: no such file; expected joints as CSV with a header {STAMP_COLUMN},<joint>,..."
            )
        if path.stat().st_size > MAX_CSV_BYTES:
            raise JointsError(f"{path}: {path.stat().st_size:,} bytes, at most {MAX_CSV_BYTES:,} are read")
        try:
            with path.open(newline="", encoding="utf-8-sig") as file:
                reader = csv.reader(file)
                names, stamps, rows = _read_rows(path, reader, lambda: reader.line_num)
        except (csv.Error, UnicodeDecodeError) as error:
            raise JointsError(f"{path}: not a CSV file in UTF-8 ({error})") from None
        columns = np.array(rows, dtype=np.float64).T
        told = dict(zip(names, columns, strict=True))
        speeds = {name for name in names if name.endswith(VELOCITY) and name.removesuffix(VELOCITY) in told}
        return cls(
            np.array(stamps, dtype=np.int64),
            {name: told[name] for name in names if name not in speeds},
            max_gap_ns,
            {name.removesuffix(VELOCITY): told[name] for name in names if name in speeds},
        )


def _columns(
    given: Mapping[str, NDArray[np.float64]], shape: tuple[int, ...]
) -> dict[str, NDArray[np.float64]]:
    """Read-only columns by joint, found to be as long as the stamps, and finite."""
    found = {}
    for joint, column in given.items():
        values = np.array(column, dtype=np.float64)
        if values.shape != shape:
            raise JointsError(f"joint record: {joint} has shape {values.shape}, its stamps have {shape}")
        if not np.isfinite(values).all():
            row = int(np.argmin(np.isfinite(values)))
            raise JointsError(f"joint record: {joint}[{row}] is {values[row]}, must be a finite number")
        values.setflags(write=False)
        found[joint] = values
    return found


def _read_rows(
    path: Path, reader: Iterator[list[str]], line_number: Callable[[], int]
) -> tuple[list[str], list[int], list[list[float]]]:
    """Names of the joints, stamps, and positions row by row."""
    header = [name.strip() for name in next(reader, [])]
    time = _time_column(path, header)
    joints = [name for n, name in enumerate(header) if n != time]
    stamps: list[int] = []
    rows: list[list[float]] = []
    for row in reader:
        if not row:
            continue
        where = f"{path}: line {line_number()}"
        if len(row) != len(header):
            raise JointsError(f"{where}: {len(row)} values, the header names {len(header)} columns")
        stamp = _stamp(row[time], where, header[time])
        if stamps and stamp <= stamps[-1]:
            raise JointsError(
                f"{where}: {header[time]} is {row[time].strip()} after {stamps[-1]} ns; stamps must strictly rise"
            )
        stamps.append(stamp)
        values = [text for n, text in enumerate(row) if n != time]
        rows.append([_finite(text, where, name) for name, text in zip(joints, values, strict=True)])
    if not rows:
        raise JointsError(f"{path}: no rows below the header; at least one is needed")
    return joints, stamps, rows


def _time_column(path: Path, header: list[str]) -> int:
    """Which column holds the times."""
    shown = ",".join(header)[:80]
    found = [n for n, name in enumerate(header) if name in STAMP_COLUMNS]
    if len(header) < 2 or len(found) != 1:
        parted = next((name for sign, name in SEPARATORS.items() if len(header) == 1 and sign in shown), "")
        times = [name for name in header if name.lower().strip("_%#") in LIKE_TIMES]
        more = f"; these are {parted}, separate columns by commas" if parted else ""
        if not more and len(found) > 1:
            more = f"; {' and '.join(header[n] for n in found)} are both there"
        elif not more and times:
            more = f"; is it {times[0]}? name it by its unit"
        raise JointsError(
            f"{path}: line 1: header is {shown!r}, must be {STAMP_COLUMN},<joint>,... with one column of times, "
            f"{', '.join(STAMP_COLUMNS)}{more}"
        )
    if len(set(header)) != len(header) or not all(header):
        raise JointsError(f"{path}: line 1: header has an empty or a doubled name, each column needs its own")
    return found[0]


def _stamp(text: str, where: str, column: str) -> int:
    """A time [ns] of a column that says its unit."""
    unit = STAMP_COLUMNS[column]
    try:
        stamp = int(text) if unit == 1 else int(Decimal(text.strip()) * unit)
    except (ValueError, ArithmeticError):
        allowed = "whole nanoseconds" if unit == 1 else "a number"
        rounded = "; a spreadsheet has rounded it" if "e" in text.lower() and unit == 1 else ""
        raise JointsError(f"{where}: {column} is {text[:40]!r}, must be {allowed}{rounded}") from None
    if not -(2**63) <= stamp < 2**63:
        raise JointsError(f"{where}: {column} is {text[:40]}, must fit 64 bits of nanoseconds")
    return stamp


def _finite(text: str, where: str, joint: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise JointsError(f"{where}: {joint} is {text[:40]!r}, must be a finite number [m or rad]")
    return value
