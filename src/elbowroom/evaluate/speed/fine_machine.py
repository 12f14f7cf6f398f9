"""What triangles cost: a machine of few of them, and the same one made of twenty times as many."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.due import Due, where
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.parallel import thread_count
from elbowroom.machine import Link, Machine, body_samples, explain_frames
from elbowroom.machine.explain import BALL_VOXEL_M
from elbowroom.machine.rasterise import drawn_mesh, rasterise
from elbowroom.motion.skin import skin_of
from elbowroom.simulate import wall_cameras

LINKS = 8
VOXEL_SIZE_M = 0.05
WALL_M = 3.5
"""What is not the machine is so far away."""
AROUND = {20_000: (25, 50), 400_000: (125, 200)}
"""By the machine's triangles, how many points a link has about its axis and along it."""
DUE = (
    Due("median_ms", "≤", 15.0, where(case="explain", triangles=400_000)),
    Due("median_ms", "≤", 1000.0, where(case="first samples", triangles=400_000)),
    Due("median_ms", "≤", 1.0, where(case="another base", triangles=400_000)),
)
"""On two cores with nothing else to do."""


def fine_machine_rows(rounds: int = 15, cameras: int = 21) -> Iterator[dict[str, Any]]:
    """Measures both machines in turns.

    Args:
        rounds: how often pixels are explained; a third of it, how often all is sampled.
        cameras: of 160 x 120 pixels along the walls.

    Yields:
        Rows of case, triangles, drawn_triangles, cameras, threads, rounds, median_ms, max_ms,
        cpu_median_ms (of all threads together), times_as_long (as the machine of few triangles).
    """
    watching = wall_cameras(cameras, size="qqvga")
    with tempfile.TemporaryDirectory() as folder, _nothing_kept():
        files = {triangles: _write(Path(folder), triangles) for triangles in AROUND}
        machines = {triangles: Machine.from_urdf(file) for triangles, file in files.items()}
        cases = {
            "explain": {n: _explaining(machine, watching) for n, machine in machines.items()},
            "first samples": {n: _sampling(machine) for n, machine in machines.items()},
            "another base": {n: _moving(machine) for n, machine in machines.items()},
        }
        for case, works in cases.items():
            times = _in_turns(works, max(3, rounds // 3) if case == "first samples" else rounds)
            few = float(np.median(times[min(times)][0]))
            for triangles, (wall, cpu) in times.items():
                yield {
                    "case": case,
                    "triangles": triangles,
                    "drawn_triangles": len(drawn_mesh(machines[triangles], 0.002)[0].faces),
                    "cameras": cameras,
                    "threads": thread_count(),
                    "rounds": len(wall),
                    "median_ms": float(np.median(wall)),
                    "max_ms": float(np.max(wall)),
                    "cpu_median_ms": float(np.median(cpu)),
                    "times_as_long": float(np.median(wall)) / few,
                }


def _in_turns(
    works: dict[int, Callable[[], object]], rounds: int
) -> dict[int, tuple[list[float], list[float]]]:
    """Milliseconds of each round of each work, by the clock and of the processor, after one that does not count."""
    times: dict[int, tuple[list[float], list[float]]] = {name: ([], []) for name in works}
    for n in range(rounds + 1):
        for name, work in works.items():
            start, cpu = time.perf_counter(), time.process_time()
            work()
            if n > 0:
                times[name][0].append(1e3 * (time.perf_counter() - start))
                times[name][1].append(1e3 * (time.process_time() - cpu))
    return times


def _explaining(machine: Machine, cameras: Sequence[DepthCamera]) -> Callable[[], object]:
    joints = machine.nearest_to_zero()
    seen = [rasterise(machine, camera, joints) for camera in cameras]
    images = [np.where(np.isfinite(depth), depth, WALL_M).astype(np.float32) for depth in seen]
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), VOXEL_SIZE_M)
    return lambda: explain_frames(machine, cameras, images, [joints] * len(cameras), grid=grid)


def _sampling(machine: Machine) -> Callable[[], object]:
    """All that the first pass makes of the links: fewer triangles, samples, balls, patches."""

    def work() -> None:
        links = tuple(Link(link.name, link.vertices, link.faces) for link in machine.links)
        new = Machine(machine.name, links, machine.joints, machine.tree)
        skin_of(new, VOXEL_SIZE_M)
        body_samples(new, BALL_VOXEL_M, unchecked=True)
        drawn_mesh(new, 0.002)

    return work


def _moving(machine: Machine) -> Callable[[], object]:
    """The same machine at another place, asked for what the sweep needs."""
    pose, skin = np.eye(4), skin_of(machine, VOXEL_SIZE_M)

    def work() -> None:
        pose[0, 3] += 0.01
        assert skin_of(machine.at(pose), VOXEL_SIZE_M) is skin

    return work


def _write(folder: Path, triangles: int) -> Path:
    """A chain of links, each a casting with ripples, ribs and flat ends; returns its URDF."""
    import trimesh  # slow to load

    parts = ['<link name="foot"/>']
    for n in range(LINKS):
        mesh = trimesh.Trimesh(*_casting(*AROUND[triangles], n), process=False)
        mesh.export(folder / f"link_{triangles}_{n}.stl")
        before = f"link_{n - 1}" if n else "foot"
        parts.append(
            f'<link name="link_{n}"><collision><geometry><mesh filename="link_{triangles}_{n}.stl"/></geometry>'
            f'</collision></link><joint name="joint_{n}" type="revolute"><parent link="{before}"/>'
            f'<child link="link_{n}"/><origin xyz="0 0 {0.22 if n else 0.3}" rpy="{0.3 * (-1) ** n} 0 0.4"/>'
            '<axis xyz="1 0 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        )
    path = folder / f"fine_{triangles}.urdf"
    path.write_text(f'<robot name="fine">{"".join(parts)}</robot>')
    return path


def _casting(around: int, along: int, number: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A closed body of 2 * around * along triangles, some 0.2 m long and 0.07 m in radius.

    Args:
        around, along: points about its axis, rings along it.
        number: which of several like it.
    """
    angle = np.arange(around) * 2 * np.pi / around
    height = np.linspace(0.0, 0.2, along)[:, None]
    radius = 0.07 - 0.02 * height / 0.2 + 0.004 * np.sin(3 * angle + number) + 0.003 * np.sin(60 * height)
    radius = radius + 0.006 * (np.abs(np.sin(2 * angle + 20 * height)) > 0.95)
    rings = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(height, radius.shape)], axis=-1
    )
    vertices = np.concatenate([rings.reshape(-1, 3), [[0.0, 0.0, 0.0], [0.0, 0.0, 0.2]]])
    here = np.arange(along * around).reshape(along, around)
    right = np.roll(here, -1, axis=1)
    below, above = (here[:-1], right[:-1]), (here[1:], right[1:])
    faces = [
        np.stack([below[0], below[1], above[1]], axis=-1),
        np.stack([below[0], above[1], above[0]], axis=-1),
        np.stack([right[0], here[0], np.full(around, along * around)], axis=-1),
        np.stack([here[-1], right[-1], np.full(around, along * around + 1)], axis=-1),
    ]
    return vertices, np.concatenate([part.reshape(-1, 3) for part in faces])


@contextmanager
def _nothing_kept() -> Iterator[None]:
    """Within it, no samples are read from disk or kept there."""
    before = os.environ.get("ELBOWROOM_CACHE")
    os.environ["ELBOWROOM_CACHE"] = ""
    try:
        yield
    finally:
        os.environ.pop("ELBOWROOM_CACHE")
        if before is not None:
            os.environ["ELBOWROOM_CACHE"] = before
