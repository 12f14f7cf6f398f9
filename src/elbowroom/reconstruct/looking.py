"""A look at the values that `reconstruct` is given, at the first moments of each group of cameras."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from elbowroom.errors import ImplausibleError, ValueWarning
from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.contradiction.findings import with_contradictions
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.reconstruct.nothing_seen import nothing_seen
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.values import look_at_images, look_at_setting
from elbowroom.sensing.values.scatter import look_at_scatter

FIRST = 3
"""Moments of the same cameras and grid that are looked at; then they are known to be usable."""
GROUPS_KEPT = 64


@dataclass(slots=True, eq=False)
class Passed:
    """How many moments of a group of cameras were looked at and nothing stopped."""

    moments: int = 0


def found_at(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    units_m: Mapping[str, float | None] | None = None,
    margin: Margin | None = None,
) -> tuple[Finding, ...]:
    """All that is found at one moment: lenses and places, images, what cameras contradict each other in, and whether
    anything ends in the grid.

    Where one of these stops, the next are not asked: what they would say follows from it.

    Args:
        grid: the watched box.
        cameras, frames: of the room, and of the moment.
        units_m: metres per unit of the files that frames were read from, by camera; what is left out is not known.
        margin: of cameras without one of their own; None: `Margin()`.
    """
    setting = look_at_setting(grid, cameras)
    if any(finding.stops for finding in setting):
        return setting
    found = (*setting, *look_at_images(grid, cameras, frames, units_m))
    found = with_contradictions(cameras, frames, margin or Margin(), found)
    found = (*found, *nothing_seen(grid, cameras, frames, margin, found))
    stops = any(finding.stops for finding in found)
    return found if stops else (*found, *look_at_scatter(cameras, frames, margin or Margin()))


def require_plausible(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    margin: Margin | None = None,
) -> bool:
    """Looks at the first moments of these cameras; whether this is one of them.

    Args:
        grid: the watched box.
        cameras, frames: of the room, and of the moment; they fit each other.
        margin: as of `found_at`.

    Raises:
        ImplausibleError: what is found cannot be meant so.

    Warns:
        ValueWarning: what is found is most likely not meant so.
    """
    passed = _passed(grid, tuple(cameras))
    if passed.moments >= FIRST:
        return False
    findings = found_at(grid, cameras, frames, margin=margin)
    refuse(findings)
    for finding in findings:
        warnings.warn(finding.text, ValueWarning, stacklevel=3)
    passed.moments += 1
    return True


def refuse(findings: Sequence[Finding]) -> None:
    """Raises ImplausibleError where one of them stops."""
    texts = [finding.text for finding in findings if finding.stops]
    if texts:
        raise ImplausibleError("; ".join(texts))


def found_in_space(space: FreeSpace) -> tuple[Finding, ...]:
    """Whether all of it is free and nothing in it is a surface: then nothing was seen that stands there.

    Args:
        space: all of the grid, without a focus.
    """
    if space.surface.any() or not space.free.all():
        return ()
    text = (
        "all of the grid is free and nothing in it is a surface, no floor and no wall: if that is not so, check the "
        "unit of depth, and numbers that stand for no return; if it is, let the grid reach to a surface that is seen"
    )
    return (Finding("no surface", (), text, stops=False),)


@lru_cache(maxsize=GROUPS_KEPT)
def _passed(grid: VoxelGrid, cameras: tuple[DepthCamera, ...]) -> Passed:
    return Passed()
