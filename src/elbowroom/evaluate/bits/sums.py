"""Free space and verdicts as check sums, so that a restructuring can show that it changed none of them by one bit.

A row is a check sum (SHA-256) of what one stage gave in one case: images, what the machine explains, evidence, the
packed planes of a free space, the text of verdicts. Sums do not depend on threads, nor on what was run before. They do
depend on floating point: on the processor and the versions of numpy, numba (LLVM) and Embree, of which the rays of the
simulated images come. So a file is compared on the computer that wrote it; where only sums of *frames* differ, the
simulator is what changed.
"""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine, explain_frames
from elbowroom.motion import JointPath, Motion, Verdict, check_motions
from elbowroom.reconstruct import DETAILS, RULES, Evidence, FreeSpace, PointReport, reconstruct
from elbowroom.reconstruct.terms import WITNESS_ANGLE_DEG
from elbowroom.sensing import DepthFrame, Margin

Row = Mapping[str, Any]
KEY = ("case", "rule", "detail", "what")
"""What names a row."""
PLANES = ("free", "surface", "blind", "disputed", "body")
"""Of a free space, `<name>_words` each."""


@dataclass(frozen=True, slots=True)
class Case:
    """Something to take sums of.

    Args:
        name: unique.
        work: gives its rows, without the case's name.
        quick: whether it is one of the few that a short run takes.
    """

    name: str
    work: Callable[[], Iterable[Row]]
    quick: bool = False

    def rows(self) -> Iterator[dict[str, Any]]:
        """Rows of case, rule, detail, what, sha256, free_pct; rule and detail None where there is none."""
        for row in self.work():
            yield {"case": self.name, **row}


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Images of a moment, and what is asked about it.

    Args:
        grid: the watched box.
        cameras: of the room.
        frames: at most one of each camera.
        margin: of cameras without one of their own.
        machine: None: none is there.
        joints: its positions by name [m or rad].
        motions: what is checked.
        witness_angle_deg: below which cameras are one witness [deg].
    """

    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    frames: Sequence[DepthFrame]
    margin: Margin
    machine: Machine | None = None
    joints: Mapping[str, float] | None = None
    motions: Sequence[Motion | JointPath] = ()
    witness_angle_deg: float = WITNESS_ANGLE_DEG


def scene_rows(scene: Scene) -> Iterator[Row]:
    """The images, what the machine explains, then free space and verdicts by every rule and detail."""
    yield frames_row(scene.frames)
    if scene.machine is not None:
        yield from _explained_rows(scene)
    for detail in DETAILS:
        for rule in RULES:
            space = reconstruct(
                scene.grid,
                scene.cameras,
                scene.frames,
                scene.machine,
                scene.joints,
                rule=rule,
                detail=detail,
                margin=scene.margin,
                witness_angle_deg=scene.witness_angle_deg,
                looks=False,
            )
            yield space_row(space, rule, detail)
            if scene.machine is not None and scene.joints is not None:
                verdicts = check_motions(space, scene.machine, scene.joints, scene.motions)
                yield verdicts_row(verdicts, rule, detail)


def frames_row(frames: Sequence[DepthFrame]) -> Row:
    """Of images, their cameras and times."""
    return row("frames", ((f"{frame.camera} {frame.stamp_ns}", frame.depth_m) for frame in frames))


def space_row(space: FreeSpace, rule: str, detail: str, what: str = "space") -> Row:
    """Of a free space, and how much of it is free.

    Args:
        space: whose planes are summed.
        rule, detail: that it was found by.
        what: the row is called.
    """
    planes = ((name, getattr(space, f"{name}_words")) for name in PLANES)
    free_pct = round(100 * float(space.free.mean()), 6)
    return {**row(what, planes, rule, detail), "free_pct": free_pct}


def verdicts_row(verdicts: Iterable[Verdict], rule: str, detail: str, what: str = "verdicts") -> Row:
    """Of verdicts, in their order.

    Args:
        verdicts: that are summed.
        rule, detail: that their space was found by.
        what: the row is called.
    """
    return row(what, [("verdicts", "\n".join(verdict_text(verdict) for verdict in verdicts))], rule, detail)


def evidence_row(evidence: Evidence, detail: str, what: str = "evidence") -> Row:
    """Of evidence, with the counts where it has them.

    Args:
        evidence: whose planes are summed.
        detail: that it was found by.
        what: the row is called.
    """
    pieces: list[tuple[str, Any]] = [
        ("cameras", " ".join(evidence.cameras)),
        ("planes", evidence.planes),
        ("unexplained", evidence.unexplained),
    ]
    if evidence.counts is not None:
        pieces += [("through", evidence.counts.through), ("disputes", evidence.counts.disputes)]
    return row(what, pieces, None, detail)


def row(
    what: str, pieces: Iterable[tuple[str, Any]], rule: str | None = None, detail: str | None = None
) -> Row:
    """A row without its case.

    Args:
        what: the stage whose outcome it is.
        pieces: names, and arrays or texts, that go into the sum in this order.
        rule, detail: by which it came about; None: by none.
    """
    return {"rule": rule, "detail": detail, "what": what, "sha256": sum_of(pieces), "free_pct": None}


def sum_of(pieces: Iterable[tuple[str, Any]]) -> str:
    """SHA-256 of named pieces: of arrays their type, shape and bytes (little endian), of all else its text."""
    total = hashlib.sha256()
    for name, piece in pieces:
        if isinstance(piece, np.ndarray):
            array = np.ascontiguousarray(piece, piece.dtype.newbyteorder("<"))
            total.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
            total.update(array.tobytes())
        else:
            total.update(f"{name}\n{piece}\n".encode())
    return total.hexdigest()


def verdict_text(verdict: Verdict) -> str:
    """All that a verdict says but for its motion; numbers to the last bit."""
    travel = f"{float(verdict.free_travel).hex()} {verdict.free_travel_unit}"
    place = _hex(verdict.place_in_world)
    return f"{verdict.level.name} {verdict.band} {travel} {verdict.cause.name} {verdict.link} {place}"


def report_text(report: PointReport) -> str:
    """All that `FreeSpace.explain` says of a point; numbers to the last bit."""
    lines = [f"{report.index} {_hex(report.centre_m)} {report.state} {report.could_settle}"]
    for seen in report.cameras:
        measured = _hex(None if seen.measured_m is None else (seen.measured_m,))
        lines.append(f"{seen.camera} {seen.sight.name} {_hex((seen.distance_m,))} {measured}")
    return "\n".join(lines)


def differences(rows: Sequence[Row], kept: Sequence[Row], left_out: Iterable[str] = ()) -> list[str]:
    """What is not the same, a sentence a row, in the order of the rows.

    Args:
        rows: of this run.
        kept: of the run before.
        left_out: names of cases that this run left out; what is kept of them is not asked for.
    """
    before = {_key(row): row for row in kept}
    now = {_key(row) for row in rows}
    found = []
    for row in rows:
        was = before.get(_key(row))
        if was is None:
            found.append(f"{_name(row)}: not in the kept file")
        elif (was["sha256"], was["free_pct"]) != (row["sha256"], row["free_pct"]):
            found.append(f"{_name(row)}: differs" + _free_words(was, row))
    missed = set(left_out)
    gone = [row for row in kept if _key(row) not in now and row["case"] not in missed]
    return found + [f"{_name(row)}: in the kept file only" for row in gone]


def _explained_rows(scene: Scene) -> Iterator[Row]:
    """What the machine explains: images as they come, so only of cameras without distortion."""
    given = {frame.camera: frame.depth_m for frame in scene.frames}
    seen = [c for c in scene.cameras if c.name in given and not any(c.intrinsics.distortion)]
    if not seen or scene.machine is None or scene.joints is None:
        return
    explained = explain_frames(
        scene.machine, seen, [given[c.name] for c in seen], [scene.joints] * len(seen), grid=scene.grid
    )
    pieces = [*explained.model_depth.items(), ("unexplained", explained.unexplained_words)]
    yield row("explained", pieces)


def _key(row: Row) -> tuple[Any, ...]:
    return tuple(row.get(name) for name in KEY)


def _name(row: Row) -> str:
    return ", ".join(str(value) for value in _key(row) if value is not None)


def _free_words(was: Row, now: Row) -> str:
    if was["free_pct"] is None or now["free_pct"] is None:
        return ""
    return f", free {now['free_pct']:.6f} % where it was {was['free_pct']:.6f} %"


def _hex(numbers: Sequence[float] | None) -> str:
    return "-" if numbers is None else " ".join(float(number).hex() for number in numbers)
