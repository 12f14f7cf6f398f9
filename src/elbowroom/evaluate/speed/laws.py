"""What ages, escape and own links cost a pass: the same pass with them and without, by turns in one process."""

import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.speed.asked_scene import save_scene
from elbowroom.evaluate.speed.bench_case import BRAKING_TIME_S, SPEEDS, Scene, summary
from elbowroom.evaluate.speed.questions import Asked
from elbowroom.garbage import uncollected, what_is_here_stays
from elbowroom.geometry import VoxelGrid, parallel
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.monitor import Cycle
from elbowroom.motion import joint_motions
from elbowroom.reconstruct import Terms
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Snapshot

OLDEST_S = 0.067
"""Ages are evenly spread from 0 to this, dealt to cameras at random."""
DUE = (
    Due(
        "share",
        "≤",
        1.10,
        lambda row: row["case"] == "ages and own links",
        "a pass with ages and own links, of one without",
    ),
)


class _Case(NamedTuple):
    name: str
    ages: bool
    own_links: bool


CASES = (
    _Case("neither", False, False),
    _Case("ages", True, False),
    _Case("own links", False, True),
    _Case("ages and own links", True, True),
)


def law_rows(asked: Asked, rounds: int = 40, seed: int = 1) -> Iterator[dict[str, Any]]:
    """A pass with ages, with own links, with both and with neither, by turns.

    Escape is on in all of them. *neither*: all images are of one moment, and no two links are compared.

    Args:
        asked: which cameras, voxels and detail.
        rounds: how many passes of each case, by turns.
        seed: which camera has which age.

    Yields:
        A row for each case: median_ms, p99_ms, max_ms, and share: its median's of that of *neither*.

    Raises:
        InputError: a pass failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.npz"
        save_scene(file, asked)
        scene = Scene.load(file, NOISE_PRESETS["tof"] if asked.noise else None)
    positions = [dict(zip(ceiling_c_arm().joint_names, row, strict=True)) for row in scene.joints]
    dealt = np.random.default_rng(seed).permutation(np.linspace(0.0, OLDEST_S, len(scene.cameras)))
    ages: list[float] = dealt.tolist()
    cycles = {case: _cycle(scene, asked, case) for case in CASES}
    spent: dict[_Case, list[float]] = {case: [] for case in CASES}
    with parallel.threads(asked.threads), what_is_here_stays():
        for n in range(rounds + 2):
            m = n % len(scene.moments)
            for case, cycle in cycles.items():
                frames = _aged(scene.moments[m], n + 1, ages if case.ages else [0.0] * len(ages))
                snapshot = Snapshot.taken(frames, positions[m], round((n + 1) * 1e9))
                with uncollected():
                    begun = time.perf_counter()
                    result = cycle.run(snapshot)
                    spent[case].append((time.perf_counter() - begun) * 1e3)
                if result.fault is not None:
                    raise InputError(f"bench: a pass failed: {result.fault}")
    # the first two passes of each fill its buffers
    rows = {case: summary(times[2:]) for case, times in spent.items()}
    for case, row in rows.items():
        said = {"case": case.name, "cameras": asked.cameras, "width": asked.width, "height": asked.height}
        said |= {"voxel_size_m": asked.voxel_size_m, "detail": asked.detail, "noise": asked.noise}
        share = row["median_ms"] / rows[CASES[0]]["median_ms"]
        yield {**said, "threads": asked.threads, "rounds": rounds, **row, "share": share}


def _aged(frames: Sequence[DepthFrame], now_s: float, ages: Sequence[float]) -> list[DepthFrame]:
    """Frames of such ages [s], one each."""
    return [
        replace(frame, stamp_ns=round((now_s - age) * 1e9)) for frame, age in zip(frames, ages, strict=True)
    ]


def _cycle(scene: Scene, asked: Asked, case: _Case) -> Cycle:
    machine = ceiling_c_arm()
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), asked.voxel_size_m)
    motions = joint_motions(machine, SPEEDS, BRAKING_TIME_S)
    if not case.own_links:
        machine = _unlinked(machine)
    return Cycle(grid, scene.cameras, machine, motions, Terms(detail=asked.detail))


def _unlinked(machine: Machine) -> Machine:
    """The same, of which all links may touch each other."""
    return replace(machine, allowed_contacts=(("*", "*"),))
