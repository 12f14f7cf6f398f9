"""Reconstruction accuracy (thesis 5.1.1, Tables 1 and 2): each voxel of each setup beside the truth.

An object voxel is one that a solid *touches*: its open box meets the solid. Besides, the milder measure: its *centre*
lies in a solid. Free voxels are all others that the machine does not touch. *found* is a share of those whose
centre some camera of the sensor sees, without the layer that touches the floor.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import Detail
from elbowroom.evaluate.rooms.room import Tally
from elbowroom.evaluate.rooms.scene import room_grid
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis.cases import cases_of, counts_of, section_picture, voxel_picture
from elbowroom.evaluate.thesis.part import Part
from elbowroom.evaluate.thesis.thesis import TABLE_2, c_arm, sensor_cameras
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Moment, Truth, render, setup, true_occupancy
from elbowroom.simulate.truth import true_centres
from elbowroom.view.report.blocks import Block, Picture, Table, Words, cm, mean, pct

DETAILS: tuple[Detail, ...] = ("point", "footprint", "pixel")
VOXEL_SIZES_M = (0.10, 0.05, 0.02)
LATERAL_PX = (0.0, 0.25, 0.5, 1.0, 1.5)
"""Widths by which the thesis' sensor trades found space for kept objects."""
DRAWN_VOXEL_M, DRAWN_AT_M = 0.05, 1.2


def tasks(settings: Settings) -> list[Task]:
    """One for each setup and sensor."""
    return [
        Task(
            "reconstruction",
            f"setup{number}-{sensor}",
            judge_setup,
            {
                "number": number,
                "sensor": sensor,
                "voxel_sizes_m": list(settings.voxel_sizes_m or VOXEL_SIZES_M),
                "cameras": settings.cameras,
                "pictures": settings.pictures,
            },
        )
        for sensor in settings.sensors
        for number in settings.setups
    ]


def judge_setup(
    number: int, sensor: str, voxel_sizes_m: Sequence[float], cameras: int, pictures: bool
) -> Outcome:
    """All voxel sizes and details of one setup and sensor, without noise and with it."""
    machine = c_arm()
    moment = setup(number).at(machine)
    rows: list[dict[str, Any]] = []
    drawn: dict[str, bytes] = {}
    exact = sensor_cameras(sensor, count=cameras)
    plain = render(exact, moment, noise=False)
    rough_cameras = sensor_cameras(sensor, noise=True, count=cameras)
    rough = render(rough_cameras, moment, seed=number)
    for edge in voxel_sizes_m:
        grid = room_grid(edge)
        case = Case(
            number, sensor, grid, machine, moment, true_occupancy(grid, moment), true_centres(grid, moment)
        )
        seen = reconstruct(grid, exact, plain, rule="any", detail="point").free
        spaces = {}
        for noise, views, frames in ((False, exact, plain), (True, rough_cameras, rough)):
            for detail in DETAILS:
                space = case.space(views, frames, detail, Margin())
                rows.append(case.row(space, seen, noise, detail, len(views), 0.5))
                if not noise:
                    spaces[detail] = space
        if sensor == "64x48" and abs(edge - 0.05) < 1e-9:
            for lateral in LATERAL_PX:
                space = case.space(exact, plain, "pixel", Margin(lateral_px=lateral))
                rows.append({**case.row(space, seen, False, "pixel", len(exact), lateral), "kind": "trade"})
        if pictures and abs(edge - DRAWN_VOXEL_M) < 1e-9:
            drawn |= case.pictures(spaces)
    return Outcome(rows, drawn)


class Case:
    """One setup at one voxel size.

    Args:
        number: of the setup.
        sensor: its name.
        grid: the watched box.
        machine, moment: what is there.
        truth, centres: which voxels are touched, and which have their centre in a solid.
    """

    def __init__(
        self,
        number: int,
        sensor: str,
        grid: VoxelGrid,
        machine: Machine,
        moment: Moment,
        truth: Truth,
        centres: NDArray[np.bool_],
    ) -> None:
        self.number, self.sensor, self.grid = number, sensor, grid
        self.machine, self.moment, self.truth, self.centres = machine, moment, truth, centres

    def space(
        self, cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame], detail: Detail, margin: Margin
    ) -> FreeSpace:
        """As reconstructed; the point test by the thesis' own rule: three overrule a surface."""
        return reconstruct(
            self.grid,
            cameras,
            frames,
            machine=self.machine,
            joints=self.moment.joints,
            rule="three",
            detail=detail,
            margin=margin,
        )

    def row(
        self,
        space: FreeSpace,
        seen: NDArray[np.bool_],
        noise: bool,
        detail: str,
        cameras: int,
        lateral_px: float,
    ) -> dict[str, Any]:
        """Shares [%] by both measures and counts of the four cases."""
        free, truth, tally = space.free, self.truth, Tally()
        tally.add(free, truth.occupied, truth.machine, seen)
        by_centre = cases_of(free, self.centres, truth.machine)
        counts = counts_of(by_centre)
        printed = TABLE_2[self.number]
        return {
            "kind": "reconstruction",
            "setup": self.number,
            "sensor": self.sensor,
            "noise": noise,
            "voxel_size_m": self.grid.voxel_size_m,
            "rule": "three",
            "detail": detail,
            "cameras": cameras,
            "lateral_px": lateral_px,
            **tally.row(),
            **counts_of(cases_of(free, truth.occupied, truth.machine)),
            "occupied_centre_pct": _share(counts["correct_object"], counts["incorrect_object"]),
            "free_centre_pct": _share(counts["correct_free"], counts["incorrect_free"]),
            "thesis_free_pct": printed[0],
            "thesis_occupied_pct": printed[1],
        }

    def pictures(self, spaces: Mapping[Detail, FreeSpace]) -> dict[str, bytes]:
        """Sections of the point test and ours side by side; the cubes of ours."""
        cases = {
            detail: cases_of(space.free, self.truth.occupied, self.truth.machine)
            for detail, space in spaces.items()
        }
        name = f"cases-{self.sensor}-setup{self.number}"
        words = {"point": "thesis' point test", "pixel": "pixel test"}
        sections = [(words[detail], cases[detail]) for detail in words if detail in cases]
        drawn = {f"{name}-section": section_picture(sections, self.grid, DRAWN_AT_M)}
        if self.sensor == "640x480":
            drawn[f"{name}-cubes"] = voxel_picture(cases["pixel"], self.grid)
        return drawn


def _share(part: int, rest: int) -> float | None:
    return 100 * part / (part + rest) if part + rest else None


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The mean over the setups of each sensor, noise, voxel size and detail, and the least occupied share."""
    result = []
    shares = ("free_pct", "found_pct", "occupied_pct", "occupied_centre_pct", "free_centre_pct")
    same = ("sensor", "noise", "voxel_size_m", "rule", "detail", "cameras", "lateral_px")
    groups = dict.fromkeys((row["kind"], *(row[key] for key in same)) for row in rows)
    for kind, *values in groups:
        of_group = [r for r in rows if r["kind"] == kind and [r[key] for key in same] == values]
        result.append(
            {
                "kind": "summary",
                "of": kind,
                "setups": [row["setup"] for row in of_group],
                **dict(zip(same, values, strict=True)),
                **{key: mean([row[key] for row in of_group if row[key] is not None]) for key in shares},
                "least_occupied_pct": min(row["occupied_pct"] for row in of_group),
            }
        )
    return result


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Tables beside the thesis' Table 2, the trade of its sensor, pictures of the four cases."""
    means = [row for row in rows if row["kind"] == "summary" and row["of"] == "reconstruction"]
    trades = [row for row in rows if row["kind"] == "summary" and row["of"] == "trade"]
    own = [row for row in rows if row["kind"] == "reconstruction"]
    blocks: list[Block] = [Words(" ".join((__doc__ or "").split("\n\n", 1)[1].split()))]
    blocks.append(
        Table(
            "Mean of the setups [%]; in brackets the least of them. Thesis: free 98.9, occupied 91.1 (its table: 90.4)",
            (
                "sensor",
                "noise",
                "voxel",
                "detail",
                "occupied, touched",
                "occupied, centre",
                "found of seen",
                "free of all",
            ),
            [
                (
                    r["sensor"],
                    "yes" if r["noise"] else "no",
                    cm(r["voxel_size_m"]),
                    r["detail"],
                    f"{pct(r['occupied_pct'], 3)} ({pct(r['least_occupied_pct'], 3)})",
                    pct(r["occupied_centre_pct"], 3),
                    pct(r["found_pct"]),
                    pct(r["free_pct"]),
                )
                for r in means
            ],
            left=(0, 1, 3),
        )
    )
    edges = sorted({r["voxel_size_m"] for r in own})
    for sensor in dict.fromkeys(r["sensor"] for r in own):
        blocks.append(_by_setup(own, sensor, edges))
    if trades:
        blocks.append(
            Table(
                "What the thesis' sensor trades: 64x48, 5 cm, no noise, pixel test, by how much a pixel is widened",
                ("widened by", "occupied, touched", "least of setups", "found of seen"),
                [
                    (
                        f"{r['lateral_px']:g} px",
                        pct(r["occupied_pct"], 3),
                        pct(r["least_occupied_pct"], 3),
                        pct(r["found_pct"]),
                    )
                    for r in trades
                ],
            )
        )
    words = "white: free, found; blue: free, not found; green: object, kept; red: object, declared free; grey: machine"
    for name, png in sorted(pictures.items()):
        wide = name.endswith("section")
        blocks.append(Picture(png, f"{name.replace('-', ' ')} (5 cm). {words}", 560 if wide else 400))
    return blocks


def _by_setup(rows: Sequence[Row], sensor: str, edges: Sequence[float]) -> Table:
    """As the thesis' Table 2: free and occupied per setup, without noise."""
    lines = []
    for number in sorted({r["setup"] for r in rows}):
        cells = [str(number), f"{TABLE_2[number][0]:.1f} / {TABLE_2[number][1]:.1f}"]
        for edge in edges:
            for detail in ("point", "pixel"):
                for r in rows:
                    key = (r["setup"], r["sensor"], r["noise"], r["voxel_size_m"], r["detail"])
                    if key == (number, sensor, False, edge, detail):
                        cells.append(f"{pct(r['free_pct'], 1)} / {pct(r['occupied_pct'], 2)}")
        lines.append(cells)
    columns = [f"{cm(edge)} {detail}" for edge in edges for detail in ("point", "pixel")]
    return Table(
        f"{sensor}, no noise: free of all / occupied (touched) [%]", ("setup", "thesis", *columns), lines
    )


PART = Part("reconstruction", "Reconstruction accuracy", tasks, summary, show)
