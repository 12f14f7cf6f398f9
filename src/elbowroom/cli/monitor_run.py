"""The run of `elbowroom monitor`: compile, then moments in, verdicts on the screen and into the file."""

import resource
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.cli.progress import Steps
from elbowroom.cli.reconstruct_run import space_of
from elbowroom.cli.room import Room, Scene
from elbowroom.cli.watching import watch_of
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import bits
from elbowroom.geometry.parallel import default_threads
from elbowroom.monitor import Cycle, CycleResult
from elbowroom.monitor.rows import cycle_rows, health_rows
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.motion import check_motions
from elbowroom.reconstruct import FreeSpace
from elbowroom.site.notes import notes_of
from elbowroom.view import save_sections
from elbowroom.view.screen.run_log import RunLog
from elbowroom.view.screen.terminal import TerminalView


def watch(room: Room, *, seconds: float | None, json_file: Path | None, out_dir: Path | None) -> None:
    """Judges one moment of the room after the other until time, recording or patience ends.

    Args:
        room: what to watch; needs a machine.
        seconds: how long; None: until Ctrl-C or the recording's end.
        json_file: where rows go; None: nowhere.
        out_dir: where pictures of the last cycle go; None: nowhere.

    Raises:
        InputError: the room has no machine or no speeds, or a file cannot be written.
    """
    machine, motions = room.machine_and_motions()
    if out_dir is not None:
        folder(out_dir)
    cycle = Cycle(
        room.grid,
        room.cameras,
        machine,
        motions,
        rule=room.rule,
        detail=room.detail,
        margin=room.margin,
        max_age_ns=room.site.max_age_ns,
        explain_tolerance_m=room.site.explain_tolerance_m,
    )
    console = Console()
    with json_rows(json_file) as add, TerminalView(room.watched, console) as view:
        for note in notes_of(room.site):
            console.print(f"note: {note}", highlight=False, soft_wrap=True)
        unwatched = _warm_up(room, cycle, console)
        if unwatched is not None:
            console.print(f"note: {unwatched}", highlight=False, soft_wrap=True)
        add(_room_row(room))
        last: tuple[Scene, CycleResult] | None = None
        said: dict[str, str] = {}
        view.start()
        with _ended_by_interrupt():
            until = time.perf_counter() + (float("inf") if seconds is None else seconds)
            for scene in room.scenes():
                result = _judge(cycle, scene)
                view.show(result, scene.source_ms)
                last = scene, result
                for row in cycle_rows(result, scene.source_ms):
                    add(row)
                for row in health_rows(result, said):
                    add(row)
                if time.perf_counter() >= until:
                    break
        view.stop()
        add(_summary_row(view.log))
    view.print_summary()
    if out_dir is not None and last is not None:
        _save_pictures(room, *last, out_dir, console)


def _judge(cycle: Cycle, scene: Scene) -> CycleResult:
    return cycle.run(scene.frames, scene.joints or {}, scene.now_ns, scene.joints_at_frames)


def _warm_up(room: Room, cycle: Cycle, console: Console) -> str | None:
    """Sets the watch, and compiles all that the loop uses, by doing it once; also where something is in the way.

    Returns:
        Why there is no watch; None: there is one.

    Raises:
        InputError: the first cycle failed, so that all would.
    """
    compile_kernels(console, machine=True, motion=True, simulator=room.site.simulated is not None)
    with Steps(console, 4) as steps:
        cycle.watch, unwatched = watch_of(room, steps)
        steps.begin("first frames")
        scene = next(room.scenes(), None)
        if scene is None:
            return unwatched
        steps.begin("motions that are blocked")
        nothing = bits.empty(room.grid)
        all_blocked = FreeSpace(room.grid, nothing, nothing, nothing, nothing)
        check_motions(all_blocked, cycle.machine, scene.joints or {}, cycle.motions)
        steps.begin("first cycle")
        result = _judge(cycle, scene)
    if result.fault is not None:
        raise InputError(f"the first cycle failed: {result.fault}")
    return unwatched


@contextmanager
def _ended_by_interrupt() -> Iterator[None]:
    """Ctrl-C, and the system's request to end, leave the block as its end would."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGTERM, before)


def _save_pictures(room: Room, scene: Scene, result: CycleResult, out_dir: Path, console: Console) -> None:
    if result.space is None:
        console.print("no pictures: the last cycle failed and has no free space", style="red")
        return
    # the cycle looked only where the motions can go; a picture shows the whole room
    paths = save_sections(space_of(room, scene), out_dir, room.machine, scene.joints, room.cameras)
    console.print(f"{len(paths)} pictures of the last cycle in {out_dir}", highlight=False, soft_wrap=True)


def _room_row(room: Room) -> dict[str, Any]:
    return {
        "kind": "room",
        "site": room.site.name,
        "voxel_size_m": room.grid.voxel_size_m,
        "shape": room.grid.shape,
        "cameras": len(room.cameras),
        "width": max(camera.width for camera in room.cameras),
        "height": max(camera.height for camera in room.cameras),
        "rule": room.rule,
        "detail": room.detail,
        "threads": default_threads(),
        "unchecked_links": room.machine.unchecked_links if room.machine else (),
    }


def _summary_row(log: RunLog) -> dict[str, Any]:
    row: dict[str, Any] = {
        "kind": "summary",
        "cycles": log.cycles,
        "rate_hz": log.whole_rate_hz,
        "faults": log.faults.total(),
        "watched": log.is_watched,
        "stop_reasons": list(log.stops.values()),
    }
    for name, values in (("cycle", log.cycle_ms), ("source", log.source_ms)):
        for statistic, share in (("median", 50), ("p99", 99), ("max", 100)):
            row[f"{name}_{statistic}_ms"] = float(np.percentile(values, share)) if values else None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    row["peak_rss_mb"] = peak / (1e6 if sys.platform == "darwin" else 1e3)
    return row
