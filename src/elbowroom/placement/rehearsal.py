"""What a placement means in use: random scenes carved with the code that will run, beside their exact truth."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.machine import Machine
from elbowroom.motion import Level, Motion, check_motions
from elbowroom.reconstruct import Evidence, FreeSpace, Terms, merge
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.explained import explain
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.resolve import decide
from elbowroom.reconstruct.witnesses import merged_by_witness, witnesses
from elbowroom.sensing import Snapshot
from elbowroom.simulate import Moment, render, true_occupancy
from elbowroom.site import Site


@dataclass(frozen=True, slots=True, eq=False)
class Settings:
    """How space is declared free in use.

    Args:
        grid: the watched box.
        terms: how strictly space is judged.
        machine: None: the bare room.
        motions: of the machine, that are judged in every scene.
    """

    grid: VoxelGrid
    terms: Terms = field(default_factory=Terms)
    machine: Machine | None = None
    motions: tuple[Motion, ...] = ()

    @classmethod
    def of_site(cls, site: Site, voxel_size_m: float | None = None) -> "Settings":
        """As a site declares space free, with its machine and motions.

        Args:
            site: the file.
            voxel_size_m: edge of a voxel instead of the site's [m].

        Raises:
            SiteError: a machine that none can be.
        """
        machine = site.machine()
        motions = site.motions(machine) if machine is not None else ()
        return cls(site.grid(voxel_size_m), site.terms(), machine, motions)


@dataclass(frozen=True, slots=True, eq=False)
class SceneResult:
    """One scene.

    Args:
        free_pct: share of the truly free voxels that is found [%].
        occupied_pct: share of the voxels touched by something other than the machine that is not declared free [%].
        contributes_pct: by camera, what of the truly free space would not be found if it had never been mounted [%].
        loss_pct: by camera, what is lost if it fails: then it disputes all that it looks at [%].
        levels: by motion, the level in the space that is found, and in the truth.
    """

    free_pct: float
    occupied_pct: float
    contributes_pct: dict[str, float]
    loss_pct: dict[str, float]
    levels: dict[str, tuple[Level, Level]]


@dataclass(frozen=True, slots=True, eq=False)
class Rehearsal:
    """Many scenes together.

    Args:
        scenes: each of them.
    """

    scenes: tuple[SceneResult, ...]

    @property
    def free_pct(self) -> float:
        """Share of truly free space that is found, mean of all scenes [%]."""
        return float(np.mean([scene.free_pct for scene in self.scenes]))

    @property
    def free_error_pct(self) -> float:
        """Standard error of that mean [%]; NaN of one scene."""
        found = [scene.free_pct for scene in self.scenes]
        return float(np.std(found, ddof=1) / np.sqrt(len(found))) if len(found) > 1 else float("nan")

    @property
    def occupied_pct(self) -> float:
        """Share of occupied voxels kept, mean of all scenes [%]."""
        return float(np.mean([scene.occupied_pct for scene in self.scenes]))

    def by_camera(self) -> dict[str, tuple[float, float]]:
        """What each camera contributes and what losing it costs, means of all scenes [%]."""
        names = self.scenes[0].loss_pct
        return {
            name: (
                float(np.mean([scene.contributes_pct[name] for scene in self.scenes])),
                float(np.mean([scene.loss_pct[name] for scene in self.scenes])),
            )
            for name in names
        }

    def false_stops(self) -> dict[str, tuple[int, int]]:
        """By motion: in how many scenes it is stopped, of those in which the truth is no stop."""
        counts = {}
        for name in self.scenes[0].levels:
            here = [scene.levels[name] for scene in self.scenes]
            going = [found for found, true in here if true is not Level.STOP]
            counts[name] = (sum(found is Level.STOP for found in going), len(going))
        return counts

    def row(self) -> dict[str, Any]:
        """A row of kind "simulate": means of all scenes [%]."""
        stops = self.false_stops().values()
        going = sum(of for _, of in stops)
        return {
            "kind": "simulate",
            "scenes": len(self.scenes),
            "free_pct": self.free_pct,
            "free_error_pct": self.free_error_pct,
            "occupied_pct": self.occupied_pct,
            "false_stop_pct": 100.0 * sum(stopped for stopped, _ in stops) / going if going else None,
            "judged_motions": going,
        }

    def part_rows(self) -> list[dict[str, Any]]:
        """A row of kind "camera" for each camera that was left out in turn, and of kind "motion" for each motion."""
        cameras = [
            {"kind": "camera", "camera": name, "contributes_pct": contributes, "loss_pct": loss}
            for name, (contributes, loss) in self.by_camera().items()
        ]
        motions = [
            {"kind": "motion", "motion": name, "false_stops": stops, "scenes_without_stop": of}
            for name, (stops, of) in self.false_stops().items()
        ]
        return [*cameras, *motions]


def rehearse(
    cameras: Sequence[DepthCamera],
    scenes: Sequence[Moment] | Iterator[Moment],
    settings: Settings,
    *,
    seed: int = 1,
    by_camera: bool = True,
    progress: Progress = silent,
) -> Rehearsal:
    """Carves every scene with the real code and compares with its truth.

    Args:
        cameras: of the placement.
        scenes: moments, each with the machine's joints.
        settings: how space is declared free.
        seed: of the sensors' noise.
        by_camera: also what each camera contributes, and what losing it costs.
        progress: called with what is being done.

    Raises:
        InputError: no camera or no scene.
    """
    if not cameras:
        raise InputError("placement: no camera, at least one is needed")
    results = []
    for number, moment in enumerate(scenes):
        progress(f"scene {number + 1}")
        results.append(_scene(cameras, moment, settings, seed + number, by_camera))
    if not results:
        raise InputError("placement: no scene, at least one is needed")
    return Rehearsal(tuple(results))


def _scene(
    cameras: Sequence[DepthCamera], moment: Moment, settings: Settings, seed: int, by_camera: bool
) -> SceneResult:
    grid, machine = settings.grid, settings.machine
    parts = evidence_by_camera(cameras, moment, settings, seed)
    truth = true_occupancy(grid, moment)
    truly_free = bits.pack(~truth.occupied & ~truth.machine, grid)
    count = max(_count(truly_free), 1)

    def share(evidence: Evidence, of: Sequence[DepthCamera]) -> tuple[FreeSpace, float]:
        space = decide(evidence, of, machine, moment.joints, settings.terms)
        return space, 100.0 * _count(space.free_words & truly_free) / count

    groups = witnesses(grid, tuple(cameras), settings.terms.witness_angle_deg)
    space, free_pct = share(merged_by_witness(parts, groups), cameras)
    contributes, loss = dict[str, float](), dict[str, float]()
    if by_camera:
        for camera, rest in zip(cameras, _all_but_one(parts, groups, settings), strict=True):
            others = [other for other in cameras if other is not camera]
            contributes[camera.name] = free_pct - share(rest, others)[1]
            loss[camera.name] = free_pct - share(rest, cameras)[1]
    levels = {}
    if machine is not None and settings.motions:
        true_space = FreeSpace.from_occupied(grid, truth.occupied).without(machine, moment.joints)
        for found, true in zip(
            check_motions(space, machine, moment.joints, settings.motions),
            check_motions(true_space, machine, moment.joints, settings.motions),
            strict=True,
        ):
            levels[found.motion.name] = (found.level, true.level)
    occupied = bits.pack(truth.occupied & ~truth.machine, grid)
    kept = 100.0 * (1 - _count(space.free_words & occupied) / max(_count(occupied), 1))
    return SceneResult(free_pct, kept, contributes, loss, levels)


def evidence_by_camera(
    cameras: Sequence[DepthCamera],
    moment: Moment,
    settings: Settings,
    seed: int,
    focus: NDArray[np.bool_] | None = None,
) -> list[Evidence]:
    """What each camera knows of a scene as `reconstruct` carves it; merged, it is what `reconstruct` decides by.

    Args:
        cameras: all of the room.
        moment: the scene.
        settings: how space is declared free.
        seed: of the sensors' noise.
        focus: blocks that are asked, as of `blocks_in_reach`; None: all.
    """
    frames = render(cameras, moment, seed=seed)
    grid, terms, images = settings.grid, settings.terms, room_images(cameras, frames)
    explained = explain(grid, settings.machine, images, Snapshot(tuple(frames), moment.joints), terms)
    return [
        carve_images(
            grid,
            images.of(camera.name),
            explained,
            terms,
            complete=terms.needs_counts,
            focus=focus,
        )
        for camera in cameras
    ]


def _all_but_one(
    parts: Sequence[Evidence], groups: Sequence[Sequence[int]], settings: Settings
) -> Iterator[Evidence]:
    """For each part all others merged, by what lies before it and what lies behind.

    Args:
        parts: of each camera.
        groups: numbers of those that are one witness each.
        settings: how space is declared free.
    """
    if groups:
        for left in range(len(parts)):
            kept = [number for number in range(len(parts)) if number != left]
            near = [[kept.index(number) for number in group if number != left] for group in groups]
            left_over = [parts[number] for number in kept]
            near = [group for group in near if group]
            yield merged_by_witness(left_over, near) if left_over else _nothing(settings)
        return
    nothing = _nothing(settings)
    behind = [nothing]
    for part in reversed(parts[1:]):
        behind.append(merge([part, behind[-1]]))
    before = nothing
    for part, rest in zip(parts, reversed(behind), strict=True):
        yield merge([before, rest])
        before = merge([before, part])


def _nothing(settings: Settings) -> Evidence:
    return Evidence.nothing(settings.grid, settings.terms.needs_counts)


def _count(words: Words) -> int:
    """Number of voxels in a plane."""
    counted: NDArray[np.uint8] = (
        np.bitwise_count(words) if hasattr(np, "bitwise_count") else np.unpackbits(words.view(np.uint8))
    )
    return int(counted.sum())
