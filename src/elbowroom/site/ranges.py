"""What numbers the field allows: beyond, a value is refused, with the unit that it most likely is in."""

from collections.abc import Callable
from typing import Any

from pydantic import AfterValidator

MILLIMETRES = (0.001, "millimetres")
CENTIMETRES = (0.01, "centimetres")
MILLISECONDS = (0.001, "milliseconds")
SECONDS = (1000.0, "seconds")
MM_A_SECOND = (0.001, "millimetres a second")
KM_AN_HOUR = (1 / 3.6, "kilometres an hour")
Guess = tuple[float, str]


def up_to(most: float, unit: str, *guesses: Guess, usual: float = 0.0) -> Any:
    """For a key: not more than this, on both sides of zero.

    Args:
        most: the greatest that is allowed.
        unit: in which it is written.
        guesses: factor and name of units that it may be in by mistake, the likeliest first.
        usual: from here on values are usual; a guess must lead to such a one.
    """
    return AfterValidator(_checked(0.0, most, unit, guesses, usual))


def between(least: float, most: float, unit: str, *guesses: Guess) -> Any:
    """For a key: from a least to a greatest number.

    Args:
        least, most: that are allowed.
        unit: in which it is written.
        guesses: as of `up_to`.
    """
    return AfterValidator(_checked(least, most, unit, guesses, least))


def _checked(
    least: float, most: float, unit: str, guesses: tuple[Guess, ...], usual: float
) -> Callable[[float], float]:
    def checked(value: float) -> float:
        if least <= abs(value) <= most:
            return value
        meant = next(
            (f"; {value:g} looks like {name}: {value * factor:g}" for factor, name in guesses
             if usual <= abs(value * factor) <= most),
            "",
        )  # fmt: skip
        raise ValueError(f"{f'{least:g} to' if least else 'at most'} {most:g} {unit}{meant}")

    return checked


LEAST_SPEED_M_S, LARGEST_SPEED_M_S = 0.5, 10.0
"""Of people: a slow walk, and more than anybody runs in a room."""


def speed_of_people(value: float) -> float:
    """The most that anything but the machine moves [m/s]; 0 says that nothing does.

    Raises:
        ValueError: people do not move like that; with the unit that it most likely is in.
    """
    if value == 0:
        return value
    return _checked(LEAST_SPEED_M_S, LARGEST_SPEED_M_S, "m/s", (MM_A_SECOND, KM_AN_HOUR), LEAST_SPEED_M_S)(
        value
    )


LARGEST_UNIT_M, LEAST_UNIT_M = 0.01, 1.5e-6
"""Centimetres, the coarsest unit that images come in; and one of which 65,534 still reach 10 cm."""


def unit_of_depth(value: float) -> float:
    """Metres per unit of 16-bit images.

    Raises:
        ValueError: no such image has that unit; with the reciprocal where somebody counted units a metre.
    """
    if LEAST_UNIT_M <= value <= LARGEST_UNIT_M:
        return value
    allowed = f"{LEAST_UNIT_M:g} to {LARGEST_UNIT_M:g} metres a unit, 0.001 for millimetres"
    if value > 1 and LEAST_UNIT_M <= 1 / value <= LARGEST_UNIT_M:
        raise ValueError(
            f"{allowed}; {value:g} looks like units a metre, of software that divides by it: write {1 / value:g}"
        )
    raise ValueError(allowed)


def mirrored_focal(axis: int) -> Callable[[float], float]:
    """For fx (0) and fy (1): above zero, and what to do where a set of data has it below."""

    def checked(value: float) -> float:
        if value > 0:
            return value
        if value == 0:
            raise ValueError("greater than 0")
        diagonal = ", ".join("-1" if n == axis else "1" for n in range(4))
        raise ValueError(
            f"greater than 0; below it the images are mirrored against the poses: mirror the world, with M = "
            f"diag({diagonal}) write M world_from_camera M for each pose and {'fx' if axis == 0 else 'fy'}: {-value:g}"
        )

    return checked
