"""Which name of a record most likely is a joint of the machine under another name."""

import difflib
import re
from collections.abc import Iterable


def meant(name: str, names: Iterable[str]) -> str:
    """In words for a message, a blank before: the name with a prefix, with other capitals, or near; "" if none is.

    Args:
        name: of the machine's joint.
        names: that the record has.
    """
    told = list(names)
    unit = next(
        (other for other in told if re.match(rf"{re.escape(name)}\s*[\[(]", other, re.IGNORECASE)), None
    )
    if unit is not None:
        return f" (is it {unit}? its name alone, and angle_unit: deg in recording if it is in degrees)"
    ends = [other for other in told if other.lower().endswith(name.lower()) and _is_a_word(name, other)]
    near = ends or difflib.get_close_matches(name, told, n=1)
    if not near:
        return ""
    if len(ends) == 1 and len(ends[0]) > len(name):
        return f" (is it {ends[0]}? rename one; machines: has joint_prefix for robots of which there are several)"
    return f" (is it {near[0]}?)"


def _is_a_word(name: str, other: str) -> bool:
    """Whether what stands before a name ends: with a slash, a dot, a line; or there is nothing."""
    before = other[: len(other) - len(name)]
    return not before or before[-1] in "/._-:"
