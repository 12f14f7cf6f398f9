"""What is as it should be: the recordings of the examples, the package's rooms, and random sites."""

from collections.abc import Iterator
from pathlib import Path

from elbowroom.evaluate.bits.cases import RECORDINGS, absent
from elbowroom.evaluate.looks.random_site import random_site
from elbowroom.evaluate.looks.scene import Scene, as_codes
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import SETUPS, InterventionRoom, Moment, render, setup, wall_cameras
from elbowroom.simulate.inside import hung_clear
from elbowroom.site import Site
from elbowroom.sources.layouts.layout import layout_of

UNIT_M = 0.0002


def recorded_scenes(examples: Path | None, data: Path | None) -> Iterator[Scene]:
    """Some moments of each recording that is there.

    Args:
        examples: folder of site files; None: none.
        data: folder with the recordings; None: none.
    """
    for name in RECORDINGS:
        if name in absent(examples, data) or examples is None:
            continue
        site = Site.load(examples / f"{name}.yaml")
        groups = layout_of(site).moments()
        for number in sorted({0, len(groups) // 2, len(groups) - 1}):
            group = groups[number]
            yield Scene(
                f"{name} {number}",
                site.grid(),
                site.cameras(),
                {image.camera.name: image.raw() for image in group},
                {image.camera.name: image.scale_m for image in group},
            )


def package_scenes() -> Iterator[Scene]:
    """The simulated room at a few times, and the thesis' six, exact and with noise."""
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), 0.05)
    room = InterventionRoom()
    moments: list[tuple[str, Moment]] = [
        (f"room at {time_s:g} s", room.at(time_s)) for time_s in (0.0, 47.0, 210.0)
    ]
    moments += [(each.name, setup(each.number).at(room.machine)) for each in SETUPS]
    for name, moment in moments:
        for noise in ("exact", "tof", "realsense_d435"):
            hung = wall_cameras(21, (2.4, 0.4), size="qqvga", noise=NOISE_PRESETS.get(noise))
            cameras = hung_clear(hung, moment.static_solids)
            frames = render(cameras, moment)
            codes = {frame.camera: as_codes(frame.depth_m, UNIT_M) for frame in frames}
            yield Scene(f"{name}, {noise}", grid, cameras, codes, dict.fromkeys(codes, UNIT_M))


def random_scenes(count: int) -> Iterator[Scene]:
    """Random sites, from the first on."""
    return (random_site(number) for number in range(count))
