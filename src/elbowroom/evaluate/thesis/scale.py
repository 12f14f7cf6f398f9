"""The scale model (thesis 5.2, 6.2): a room at 1:5 with C-arm, table, doctor and four Kinects; free travel and truth.

Ours is simulated, the thesis' was a physical model: same scale, same kind of sensor (noise and near limit of a Kinect
v1), but exact meshes for truth where the thesis used a ruler. Poses are drawn at random; every joint and direction that
truly ends at an object within five braking distances is judged. Shortfalls are those of the point that touches, in
millimetres of the model. The thesis restricts its scene to what four Kinects can see. Ours keeps every motion and says,
by exact rays and not by verdicts, whether its way is *in view*: each voxel that the moving links come to touch, up to
two voxels before the contact and at least 5 mm, is wholly seen by one camera, but for what the body covers. Where it is
not, free travel ends at the first voxel that no one camera sees all of, unless several see it between them; how much
earlier it ends is *short of the view*, below zero where it goes on. The cameras were placed for these motions and for
the smaller voxels (`elbowroom evaluate scale-cameras`). With these the body is grown by more than half a voxel, so that
it takes the same space as with the larger ones. *Noise* is sigma(z) of Kinect v1; *and losses* adds to it what the
simulated time-of-flight sensors suffer: mixed pixels at edges, and pixels without a return.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.due import Due, figure_of, where
from elbowroom.evaluate.rooms.exact import Contact
from elbowroom.evaluate.rooms.scene import DECIMALS, SAME, WELL_KNOWN, lean, only
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.tables import table_of
from elbowroom.evaluate.thesis.due import DueLine
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.evaluate.thesis.scale_model import (
    FACTOR,
    PICTURE_VOXEL_M,
    POSES,
    VOXEL_SIZES_M,
    body_growth,
    coloured_picture,
    kinects,
    model_grid,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.thesis.way_view import WayView
from elbowroom.extras import package
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.motion import Motion, Verdict, blocks_in_reach, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, render
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.view.report.blocks import Block, Picture

NEAR_VOXELS, NEAR_M = 2, 0.005
"""A way is in view if it is so up to two voxels before the contact, or to what the thesis was off by [m]."""
EXPLAIN_M = 0.01 * FACTOR
"""How far from the machine's model a return may lie and still be the machine: the usual centimetre at 1:5 [m]."""
SENSORS = {
    (False, False): "none",
    (True, False): "Kinect v1",
    (True, True): "Kinect v1, and losses",
}
"""By noise and losses, as the table calls them."""


def _finest(rows: Sequence[Row], due: Due) -> Row:
    """What is due is due with the smallest voxels."""
    return min(rows, key=lambda row: float(row["voxel_size_m"]))


_OF = where(kind="summary", noise=True, losses=False)
DUE = (
    DueLine(
        "more_than_truth",
        "≤",
        0,
        _OF,
        name="scale model, noise: more than the truth, of {motions}",
        pick=_finest,
    ),
    *(
        DueLine(
            f"{key}_in_view_short_mm",
            "≤",
            most,
            _OF,
            name=f"scale model, noise, the {{in_view}} ways in view: short by, {key} [mm]",
            thesis="5",
            pick=_finest,
        )
        for key, most in (("median", 5), ("worst", 12))
    ),
)


def tasks(settings: Settings) -> list[Task]:
    """One for each pose.

    Raises:
        PackageError: coal is not installed.
    """
    package("coal")
    edges = [FACTOR * edge for edge in settings.voxel_sizes_m or ()] or list(VOXEL_SIZES_M)
    return [
        Task("scale", f"pose{pose}", judge_pose, {"pose": pose, "voxel_sizes_m": edges, "picture": pose == 0})
        for pose in range(POSES)
    ]


def judge_pose(pose: int, voxel_sizes_m: Sequence[float], picture: bool) -> Outcome:
    """The motions from one pose that truly end at an object, by each size of voxel and kind of sensor.

    Args:
        pose: its number.
        voxel_sizes_m: edges of voxels [m of the model].
        picture: whether to draw what is seen.
    """
    joints, met = model_pose(pose)
    moment = Moment(1.0, model_solids() + link_solids(model_machine(), joints), joints)
    rows = [row for edge in voxel_sizes_m for row in _judged(pose, met, moment, edge)]
    drawn: dict[str, bytes] = {}
    if picture:
        drawn["scale-model"] = coloured_picture(
            _space(model_grid(PICTURE_VOXEL_M), moment, True, True, pose, None), moment
        )
    return Outcome(rows, drawn)


def _judged(
    pose: int, met: Mapping[Motion, Contact], moment: Moment, voxel_size_m: float
) -> list[dict[str, Any]]:
    machine, grid, motions = model_machine(), model_grid(voxel_size_m), list(met)
    view = WayView(machine, moment, grid, body_growth(voxel_size_m))
    in_view = {
        motion: view.travel_in_view(view.way(motion, contact.travel), kinects(False), contact.travel)
        for motion, contact in met.items()
    }
    focus = blocks_in_reach(grid, machine, moment.joints, motions)
    rows: list[dict[str, Any]] = []
    for noise, losses in SENSORS:
        space = _space(grid, moment, noise, losses, pose, focus)
        verdicts = check_motions(space, machine, moment.joints, motions)
        sensor = {"sensor": "kinect_v1", "noise": noise, "losses": losses, "voxel_size_m": voxel_size_m}
        for motion, verdict in zip(motions, verdicts, strict=True):
            rows.append(
                {
                    "kind": "travel",
                    "setup": "scale model",
                    "motion": motion.name,
                    "pose": pose,
                    **sensor,
                    "rule": "three",
                    "detail": "pixel",
                    **_compared(met[motion], verdict, in_view[motion], voxel_size_m),
                }
            )
    return rows


def _space(
    grid: VoxelGrid, moment: Moment, noise: bool, losses: bool, seed: int, focus: NDArray[np.bool_] | None
) -> FreeSpace:
    """What four Kinects see to be free at a moment; focus None: in all of the grid."""
    views = kinects(noise)
    return reconstruct(
        grid,
        views,
        render(views, moment, seed=seed) if losses else noisy_frames(views, moment, seed),
        machine=model_machine(),
        joints=moment.joints,
        margin=WELL_KNOWN,
        explain_tolerance_m=EXPLAIN_M,
        body_growth_m=body_growth(grid.voxel_size_m),
        focus=focus,
        looks=False,
    )


def noisy_frames(views: Sequence[DepthCamera], moment: Moment, seed: int) -> list[DepthFrame]:
    """Exact images, with the noise of each camera's model and none of what else `render` does to them.

    Args:
        views: the cameras.
        moment: what is there.
        seed: of the noise.
    """
    frames = render(views, moment, noise=False)
    return [with_noise(*pair, [seed, number]) for number, pair in enumerate(zip(views, frames, strict=True))]


def with_noise(camera: DepthCamera, frame: DepthFrame, seed: Sequence[int]) -> DepthFrame:
    """An exact image with the noise of its camera's model, if that has any.

    Args:
        camera, frame: whose image.
        seed: of the noise.
    """
    depth = frame.depth_m.astype(np.float64)
    if camera.noise is not None:
        normal = np.random.default_rng(seed).standard_normal(depth.shape)
        depth = np.where(depth > 0, depth + normal * camera.noise.sigma(depth), 0.0)
    return DepthFrame(frame.camera, frame.stamp_ns, depth.astype(np.float32))


def near_m(voxel_size_m: float) -> float:
    """Up to how long before the contact a way has to be in view [m]."""
    return max(NEAR_M, NEAR_VOXELS * voxel_size_m)


def _compared(
    contact: Contact, verdict: Verdict, travel_in_view: float, voxel_size_m: float
) -> dict[str, Any]:
    def short_mm(travel: float) -> float:
        return 1000 * (contact.travel - travel) * contact.speed

    hidden_mm = short_mm(travel_in_view)
    return {
        "in_view": hidden_mm <= 1000 * near_m(voxel_size_m),
        **only(lean(verdict.row()), ("free_travel", "free_travel_unit", "cause")),
        "truth_travel": round(contact.travel, DECIMALS),
        "travel_in_view": round(travel_in_view, DECIMALS),
        "true_solid": contact.solid,
        "short_mm": round(short_mm(verdict.free_travel), 3),
        "short_of_view_mm": round(short_mm(verdict.free_travel) - hidden_mm, 3),
        "more_than_truth": verdict.free_travel > contact.travel + SAME,
    }


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """By voxel and sensor: travel beyond the truth, shortfall in millimetres of the model, by view and of all."""
    result = []
    kinds = dict.fromkeys((row["voxel_size_m"], row["noise"], row["losses"]) for row in rows)
    for kind in sorted(kinds):
        edge, noise, losses = kind
        mine = [row for row in rows if (row["voxel_size_m"], row["noise"], row["losses"]) == kind]
        view = [row for row in mine if row["in_view"]]
        hidden = [row for row in mine if not row["in_view"]]
        result.append(
            {
                "kind": "summary",
                "noise": noise,
                "losses": losses,
                "voxel_size_m": edge,
                "motions": len(mine),
                "in_view": len(view),
                "more_than_truth": sum(row["more_than_truth"] for row in mine),
                **_median_and_worst("short_mm", "short_mm", mine),
                **_median_and_worst("in_view_short_mm", "short_mm", view),
                **_median_and_worst("hidden_short_mm", "short_mm", hidden),
                **_median_and_worst("hidden_short_of_view_mm", "short_of_view_mm", hidden),
            }
        )
    return result


def _median_and_worst(name: str, key: str, rows: Sequence[Row]) -> dict[str, float | None]:
    values = [row[key] for row in rows]
    return {
        f"median_{name}": float(np.median(values)) if values else None,
        f"worst_{name}": max(values, default=None),
    }


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """The table, and the coloured reconstruction."""
    median, worst = (figure_of(DUE, f"{key}_in_view_short_mm") for key in ("median", "worst"))
    table = table_of(
        f"Free travel; thesis: within 5 mm; due: never more than the truth, {median:g} mm median, "
        f"{worst:g} mm worst",
        [row for row in rows if row["kind"] == "summary"],
        {
            "noise": lambda row: SENSORS[row["noise"], row["losses"]],
            "voxel": lambda row: f"{row['voxel_size_m'] * 1000:g} mm",
            "more than the truth": "{more_than_truth} of {motions}",
            "ways in view": "{in_view}",
            "short by, median / worst [mm]": lambda row: _pair(row, "in_view_short_mm"),
            "ways not in view": lambda row: str(row["motions"] - row["in_view"]),
            "short by [mm]": lambda row: _pair(row, "hidden_short_mm"),
            "of these short of the view [mm]": lambda row: _pair(row, "hidden_short_of_view_mm"),
            "all: short by [mm]": lambda row: _pair(row, "short_mm"),
        },
        left=("noise",),
    )
    caption = "Surfaces found by four Kinects: C-arm blue, table green, doctor red (Fig. 10)"
    return [about(__doc__), table, *(Picture(png, caption, 560) for png in pictures.values())]


def _pair(row: Row, name: str) -> str:
    """Median and worst."""
    pair = (row[f"median_{name}"], row[f"worst_{name}"])
    return " / ".join("-" if value is None else f"{value:.1f}" for value in pair)


PART = Part("scale", "Scale model", tasks, summary, show, DUE)
