"""What is compiled before the first cycle, in jobs that can run beside each other.

Run as a program it does the jobs that are named on its standard input, one a line, and says of each when it is done.
Numba compiles one function at a time in a process, but several processes fill one cache on disk.
"""

import gc
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Literal

GARBAGE = (100_000, 20, 20)
"""A compiler makes millions of objects that stay for a while: looking through them as often as Python does by itself
takes a sixteenth of the processor time of compiling."""
Needs = Literal["always", "machine", "motion", "simulator"]


@dataclass(frozen=True, slots=True)
class Job:
    """Kernels that are compiled together.

    Args:
        name: what the screen calls them.
        run: runs each of them once, on something tiny.
        last: module and name of the kernel that is compiled last.
        needs: what a run must have for them to be of use.
        after: name of a job whose kernels these ones call; if both ran at once, its work would be done twice.
    """

    name: str
    run: Callable[[], None]
    last: tuple[str, str]
    needs: Needs = "always"
    after: str | None = None

    @property
    def is_kept(self) -> bool:
        """Whether the cache on disk knows its last kernel."""
        module, kernel = self.last
        where = Path(getattr(import_module(module), kernel).stats.cache_path)
        return any(where.glob(f"{module.rpartition('.')[2]}.{kernel}-*.nbi"))


def _pixel_test() -> None:
    from elbowroom.reconstruct.warm_up import warm_up_pixel_test

    warm_up_pixel_test()


def _carving() -> None:
    from elbowroom.reconstruct.warm_up import warm_up

    warm_up(details=("pixel",))


def _body() -> None:
    from elbowroom.geometry import VoxelGrid
    from elbowroom.machine import body_words
    from elbowroom.machine.probe import probe

    body_words(probe(), {"slide": 0.0}, VoxelGrid((-0.2, -0.2, -0.2), (8, 8, 8), 0.05))


def _machine_in_images() -> None:
    import numpy as np

    from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
    from elbowroom.machine import explain_frames
    from elbowroom.machine.probe import probe

    camera = DepthCamera("one", 32, 24, np.eye(4), Intrinsics(30, 30, 15.5, 11.5))
    depth = np.ones((24, 32), dtype=np.float32)

    grid = VoxelGrid((-0.2, -0.2, -0.2), (8, 8, 8), 0.05)
    explain_frames(probe(), [camera], [depth], [{"slide": 0.0}], grid=grid)


def _motion() -> None:
    from elbowroom.geometry import VoxelGrid, bits
    from elbowroom.machine.probe import probe
    from elbowroom.motion import Motion, blocks_in_reach, check_motion, link_distances
    from elbowroom.reconstruct import FreeSpace

    grid = VoxelGrid((-0.2, -0.2, -0.2), (8, 8, 8), 0.05)
    nothing = bits.empty(grid)
    motion = Motion("slide", 1, 0.01)
    for free in (nothing, ~nothing):
        space = FreeSpace(grid, free, nothing, nothing, nothing)
        check_motion(space, probe(), {"slide": 0.0}, motion)
        link_distances(space, probe(), {"slide": 0.0}, 0.1)
    blocks_in_reach(grid, probe(), {"slide": 0.0}, [motion])


def _own_links() -> None:
    import numpy as np

    from elbowroom.machine import Part
    from elbowroom.machine.probe import probe
    from elbowroom.motion import Motion
    from elbowroom.motion.course import way_of
    from elbowroom.motion.meeting import Meeting

    beside = np.eye(4)
    beside[0, 3] = 0.3
    both = replace(probe().with_part("base", Part.box("part", (0.1, 0.1, 0.1)), beside), allowed_contacts=())
    start = both.positions({"slide": 0.0})
    way = way_of(both, start, Motion("slide", 1, 0.01))
    Meeting.of(both, both.world_from_link_array(start[None])[0]).first(way, way.length)


def _stops() -> None:
    import numpy as np

    from elbowroom.geometry import VoxelGrid, bits
    from elbowroom.machine import Part
    from elbowroom.machine.probe import probe
    from elbowroom.motion import Braking, MachineState, check_stop
    from elbowroom.reconstruct import FreeSpace

    grid = VoxelGrid((-0.5, -0.5, -0.5), (20, 20, 20), 0.05)
    beside = np.eye(4)
    beside[0, 3] = 0.3  # what touches already is not asked how soon it meets
    both = replace(probe().with_part("base", Part.box("part", (0.1, 0.1, 0.1)), beside), allowed_contacts=())
    state = MachineState({"slide": 0.0}, {"slide": 0.1})
    nothing = bits.empty(grid)
    for free in (nothing, ~nothing):
        space = FreeSpace(grid, free, nothing, nothing, nothing)
        check_stop(space, both, state, Braking({"slide": 0.1}, {"slide": 0.1}))


def _watch() -> None:
    from elbowroom.monitor.start.warm_up import warm_up_watch

    warm_up_watch()


def _simulated_cameras() -> None:
    from elbowroom.geometry.noise import NoiseModel
    from elbowroom.simulate import InterventionRoom, render, wall_cameras

    for noise in (NoiseModel(constant_m=0.001), None):
        render(wall_cameras(1, width=32, height=24, noise=noise), InterventionRoom().at(0.0), seed=0)


JOBS = (
    Job("the machine's body", _body, ("elbowroom.machine.kernels.body", "mark_points"), "machine"),
    Job("the pixel test", _pixel_test, ("elbowroom.reconstruct.kernels.parts", "ask_parts")),
    Job(
        "the machine in images",
        _machine_in_images,
        ("elbowroom.machine.kernels.explain", "explain"),
        "machine",
        "the machine's body",
    ),
    Job(
        "carving",
        _carving,
        ("elbowroom.reconstruct.kernels.carve", "carve_cubes"),
        after="the pixel test",
    ),
    Job(
        "motions",
        _motion,
        ("elbowroom.motion.kernels.focus", "mark_ways"),
        "motion",
        "the machine's body",
    ),
    Job(
        "own links",
        _own_links,
        ("elbowroom.motion.kernels.meeting", "first_meeting"),
        "motion",
        "the machine's body",
    ),
    Job(
        "stops beside a path",
        _stops,
        ("elbowroom.motion.kernels.beside", "pair_in_box"),
        "motion",
        "own links",
    ),
    Job(
        "the watch",
        _watch,
        ("elbowroom.monitor.health.drift.kernels.body", "surface_spots"),
        "motion",
        "the machine in images",
    ),
    Job(
        "simulated cameras",
        _simulated_cameras,
        ("elbowroom.simulate.kernels.sensor", "as_delivered"),
        "simulator",
    ),
)
"""In the order in which they are begun: what others wait for first, the shortest last."""


def main() -> None:
    """Does the jobs that come in, by name, until there are no more."""
    gc.set_threshold(*GARBAGE)
    by_name = {job.name: job for job in JOBS}
    for line in sys.stdin:
        by_name[line.strip()].run()
        print(line.strip(), flush=True)


if __name__ == "__main__":
    main()
