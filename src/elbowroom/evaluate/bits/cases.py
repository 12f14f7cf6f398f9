"""The cases whose sums are taken: the simulated room, the thesis' setups, recordings, and what goes about them."""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from elbowroom.evaluate.bits.passes import cycle_rows, explain_rows, merge_rows, placement_rows, settings_rows
from elbowroom.evaluate.bits.room import AMONG_PEOPLE, AT_THE_EDGE, BARREL, TURNED, WIDE, Shot, simulated_rows
from elbowroom.evaluate.bits.sums import Case, Row, Scene, scene_rows
from elbowroom.simulate import SETUPS, InterventionRoom, setup
from elbowroom.site import Site
from elbowroom.sources import moments

RECORDINGS = ("sevenscenes", "piv_table_2cam", "apc_wrist_multiview", "kinect_board_2cam")
"""Site files of the examples, named as their folders of data are."""


ROOM: Mapping[str, Shot] = {
    "exact": Shot(0.0),
    "exact, turned": Shot(7.0, TURNED, quick=True),
    "exact, wide margin": Shot(19.0, margin=WIDE),
    "exact, among people": Shot(12.5, AMONG_PEOPLE),
    "noise": Shot(3.0, noise="tof", quick=True),
    "noise, turned": Shot(11.0, TURNED, noise="tof"),
    "noise, wide margin": Shot(26.0, noise="kinect_v1", margin=WIDE),
    "noise, many lost and mixed": Shot(5.0, noise="tof", missing=0.05, flying_pixels=0.8),
    "noise, silent cameras": Shot(9.0, AMONG_PEOPLE, noise="tof", silent=2),
    "noise, short range": Shot(14.0, noise="tof", camera={"min_depth_m": 0.5, "max_depth_m": 3.0}),
    "alone": Shot(2.0, TURNED, noise="tof", alone=True, quick=True),
    "alone, exact, at the edge": Shot(2.0, AT_THE_EDGE, alone=True, half_side_m=1.3),
    "alone, 640x480": Shot(4.0, size="vga", noise="tof", alone=True),
    "radial, 64x48": Shot(7.0, size="thesis", noise="tof", quick=True),
    "radial, 64x48, exact": Shot(16.0, TURNED, size="thesis"),
    "distorted": Shot(21.0, noise="tof", camera={"distortion": BARREL}),
    "640x480": Shot(7.0, TURNED, size="vga", noise="tof", quick=True),
    "2 cm, exact": Shot(3.0, voxel_size_m=0.02, quick=True),
    "2 cm, alone, exact": Shot(2.0, AMONG_PEOPLE, voxel_size_m=0.02, alone=True),
    "2 cm, noise, 640x480": Shot(7.0, AMONG_PEOPLE, voxel_size_m=0.02, size="vga", noise="tof"),
}
"""Of the simulated room, by name."""
QUICK_SETUPS = (4, 5)
QUICK_RECORDINGS = ("sevenscenes", "piv_table_2cam")


def cases(examples: Path | None, data: Path | None) -> list[Case]:
    """All of them, in their order; recordings come last.

    Args:
        examples: folder of their site files; None: without recordings.
        data: folder with the recordings, where the site files look for them; only those that are there are taken.
    """
    found = [Case(f"room: {name}", partial(_room_rows, shot), shot.quick) for name, shot in ROOM.items()]
    for each in SETUPS:
        quick = each.number in QUICK_SETUPS
        found.append(Case(each.name, partial(_setup_rows, each.number, -1, None), quick))
        found.append(Case(f"{each.name}: noise", partial(_setup_rows, each.number, 0, "tof")))
    found += [
        Case("cycle", cycle_rows, quick=True),
        Case("merge", merge_rows, quick=True),
        Case("explain", explain_rows, quick=True),
        Case("settings", settings_rows),
        Case("placement", placement_rows, quick=True),
    ]
    for name in RECORDINGS:
        if name not in absent(examples, data):
            assert examples is not None
            work = partial(_recording_rows, examples / f"{name}.yaml")
            found.append(Case(name, work, name in QUICK_RECORDINGS))
    return found


def absent(examples: Path | None, data: Path | None) -> list[str]:
    """Names of the recordings of which the site file or the data is not there."""
    if examples is None or data is None:
        return list(RECORDINGS)
    return [
        name for name in RECORDINGS if not ((examples / f"{name}.yaml").is_file() and (data / name).is_dir())
    ]


def _room_rows(shot: Shot) -> Iterator[Row]:
    room = InterventionRoom(people=not shot.alone, furniture=not shot.alone)
    moment = room.at(shot.time_s, joints=shot.joints)
    yield from simulated_rows(moment, room.machine, shot)


def _setup_rows(number: int, movement: int, noise: str | None) -> Iterator[Row]:
    """A setup with the C-arm where one of its movements is asked."""
    room = setup(number)
    machine = InterventionRoom().machine
    moment = room.at(machine, room.joints_before(room.movements[movement]))
    yield from simulated_rows(moment, machine, Shot(0.0, noise=noise))


def _recording_rows(path: Path) -> Iterator[Row]:
    """The first moment of a recording and the last, at the site's own voxels."""
    site = Site.load(path)
    every = list(moments(site))
    for which, moment in {"first": every[0], "last": every[-1]}.items():
        angle_deg = site.terms().witness_angle_deg
        scene = Scene(site.grid(), site.cameras(), moment.frames, site.margin(), witness_angle_deg=angle_deg)
        for each in scene_rows(scene):
            yield {**each, "what": f"{which} {each['what']}"}
        if len(every) == 1:
            break
