"""One setup at one voxel size: what is there, what is found, the four cases of each voxel."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from elbowroom.choices import Detail
from elbowroom.evaluate.rooms.room import Tally
from elbowroom.evaluate.thesis.cases import cases_of, counts_of, section_picture, voxel_picture
from elbowroom.evaluate.thesis.thesis import TABLE_2, c_arm
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Moment, true_occupancy
from elbowroom.simulate.truth import true_centres

DRAWN_AT_M = 1.2
"""Height of the section that is drawn [m]."""


class Images(NamedTuple):
    """What one kind of sensor sees of a setup.

    Fields:
        cameras, frames: one frame a camera.
        noise: whether the sensor has any.
    """

    cameras: Sequence[DepthCamera]
    frames: Sequence[DepthFrame]
    noise: bool


class SetupVoxels:
    """One setup at one voxel size.

    Args:
        number: of the setup.
        moment: what is there.
        grid: the watched box.
        exact: images without noise; what they see of a voxel's centre could be found.
    """

    def __init__(self, number: int, moment: Moment, grid: VoxelGrid, exact: Images) -> None:
        self.number, self.moment, self.grid = number, moment, grid
        self.truth, self.centres = true_occupancy(grid, moment), true_centres(grid, moment)
        self.seen = reconstruct(
            grid, exact.cameras, exact.frames, rule="any", detail="point", looks=False
        ).free

    def space(self, images: Images, detail: Detail, margin: Margin) -> FreeSpace:
        """As reconstructed; the point test by the thesis' own rule: three overrule a surface.

        Args:
            images: that are carved.
            detail, margin: as of `reconstruct`.
        """
        return reconstruct(
            self.grid,
            images.cameras,
            images.frames,
            machine=c_arm(),
            joints=self.moment.joints,
            rule="three",
            detail=detail,
            margin=margin,
            looks=False,
        )

    def row(self, space: FreeSpace, images: Images, detail: Detail, margin: Margin) -> dict[str, Any]:
        """Shares [%] by both measures and counts of the four cases.

        Args:
            space: found by `space`.
            images, detail, margin: that it was given.
        """
        free, truth, tally, first = space.free, self.truth, Tally(), images.cameras[0]
        tally.add(free, truth.occupied, truth.machine, self.seen)
        by_centre = cases_of(free, self.centres, truth.machine)
        counts = counts_of(by_centre)
        printed = TABLE_2[self.number]
        return {
            "kind": "reconstruction",
            "setup": self.number,
            "sensor": f"{first.width}x{first.height}",
            "noise": images.noise,
            "voxel_size_m": self.grid.voxel_size_m,
            "rule": "three",
            "detail": detail,
            "cameras": len(images.cameras),
            "lateral_px": margin.lateral_px,
            **tally.row(),
            **counts_of(cases_of(free, truth.occupied, truth.machine)),
            "occupied_centre_pct": _share(counts["correct_object"], counts["incorrect_object"]),
            "free_centre_pct": _share(counts["correct_free"], counts["incorrect_free"]),
            "thesis_free_pct": printed[0],
            "thesis_occupied_pct": printed[1],
        }

    def pictures(self, sensor: str, spaces: Mapping[Detail, FreeSpace]) -> dict[str, bytes]:
        """Sections of the point test and ours side by side; the cubes of ours."""
        cases = {
            detail: cases_of(space.free, self.truth.occupied, self.truth.machine)
            for detail, space in spaces.items()
        }
        name = f"cases-{sensor}-setup{self.number}"
        words = {"point": "thesis' point test", "pixel": "pixel test"}
        sections = [(words[detail], cases[detail]) for detail in words if detail in cases]
        drawn = {f"{name}-section": section_picture(sections, self.grid, DRAWN_AT_M)}
        if sensor == "640x480":
            drawn[f"{name}-cubes"] = voxel_picture(cases["pixel"], self.grid)
        return drawn


def _share(part: int, rest: int) -> float | None:
    return 100 * part / (part + rest) if part + rest else None
