"""How much of the figures of placement is measured."""

from dataclasses import dataclass

MOMENTS_S = (0.0, 7.0, 19.0, 31.0, 43.0, 57.0)


@dataclass(frozen=True, slots=True)
class Effort:
    """How much of it is measured.

    Args:
        verifications: besides the first, which compiles.
        counts: numbers of cameras of the sweep.
        seconds: for each optimisation [s].
        scenes, setup_scenes: random scenes of the simulated room, and of each setup.
        moments_s: of the simulated room's course [s].
    """

    verifications: int = 5
    counts: tuple[int, ...] = tuple(range(3, 41))
    seconds: float = 60.0
    scenes: int = 12
    setup_scenes: int = 4
    moments_s: tuple[float, ...] = MOMENTS_S


FULL = Effort()
"""What benchmarks/results holds."""
QUICK = Effort(1, (3, 21), 5.0, 2, 1, MOMENTS_S[:1])
"""A first impression."""
