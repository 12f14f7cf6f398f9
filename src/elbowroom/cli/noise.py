"""The option `--noise`."""

from elbowroom.errors import InputError
from elbowroom.sensing import NOISE_PRESETS, NoiseModel

EXACT = "exact"


def noise_named(name: str) -> NoiseModel | None:
    """The noise of a sensor; None: depth is exact.

    Raises:
        InputError: neither exact nor a sensor that is known.
    """
    if name != EXACT and name not in NOISE_PRESETS:
        raise InputError(f"--noise: {name!r} is unknown, allowed are {', '.join([EXACT, *NOISE_PRESETS])}")
    return NOISE_PRESETS.get(name)
