"""Values of this package as JSON and back, every number to the last bit. Nothing is made but what is on the list."""

import base64
import binascii
import dataclasses
import json
import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from elbowroom.errors import BagError, ElbowroomError, PoseWarning
from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.intrinsics import Intrinsics
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import Machine
from elbowroom.machine.contact import Contact
from elbowroom.machine.joint import Joint, Mimic
from elbowroom.machine.joint_state import JointTolerance
from elbowroom.machine.kernels.body import Tree
from elbowroom.machine.link import Link, Surface
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.stand import Stand
from elbowroom.machine.zone import Zone
from elbowroom.motion import Braking, Motion, Override
from elbowroom.motion.separation import Separation
from elbowroom.reconstruct import Terms

KINDS = {
    kind.__name__: kind
    for kind in (
        Braking,
        Contact,
        DepthCamera,
        Finding,
        Intrinsics,
        Joint,
        JointTolerance,
        Link,
        Machine,
        Margin,
        Mimic,
        Motion,
        NoiseModel,
        Override,
        OwnLinks,
        Separation,
        Stand,
        Surface,
        Terms,
        Tree,
        VoxelGrid,
        Zone,
    )
}
"""What is read back."""
ARRAYS = {
    name: np.dtype(name) for name in ("<f8", "<f4", "<i8", "<i4", "|i1", "|u1", "|b1", "<u2", "<u4", "<u8")
}
"""Types of numbers that arrays may have."""


def kept(value: Any) -> Any:
    """A value in what JSON knows.

    Raises:
        TypeError: of a kind that is not read back.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, np.ndarray):
        little = np.ascontiguousarray(value, value.dtype.newbyteorder("<"))
        data = base64.b64encode(little.tobytes()).decode()
        return {"array": little.dtype.str, "shape": list(value.shape), "data": data}
    if type(value).__name__ in KINDS:
        fields = {name: kept(getattr(value, name)) for name in _names(type(value))}
        return {"of": type(value).__name__, "fields": fields}
    if isinstance(value, Mapping):
        return {"map": [[kept(key), kept(item)] for key, item in value.items()]}
    if isinstance(value, tuple | list):
        return [kept(item) for item in value]
    raise TypeError(f"{type(value).__name__} is not kept")


def text_of(value: Any) -> str:
    """A value as the text that stands for it: equal values of one version have equal texts."""
    return json.dumps(kept(value), separators=(",", ":"), allow_nan=False, ensure_ascii=False)


def read(text: str | bytes, what: str) -> Any:
    """The value of a text; lists come back as tuples.

    Args:
        text: as of `text_of`.
        what: names it in errors.

    Raises:
        BagError: malformed, or of a kind that is not on the list.
    """
    return made_of(parsed(text, what), what)


def parsed(text: str | bytes, what: str) -> Any:
    """What JSON holds.

    Args:
        text: that is read.
        what: names it in errors.

    Raises:
        BagError: it is none.
    """
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BagError(f"{what}: malformed ({type(error).__name__}: {error})") from None


def made_of(given: Any, what: str) -> Any:
    """The value that `kept` gave.

    Args:
        given: what JSON holds.
        what: names it in errors.

    Raises:
        BagError: it is none.
    """
    try:
        with warnings.catch_warnings():
            # it was said when the value was made first
            warnings.simplefilter("ignore", PoseWarning)
            return made(given)
    except (
        ElbowroomError,
        ValueError,
        TypeError,
        KeyError,
        AttributeError,
        RecursionError,
        OverflowError,
    ) as error:
        raise BagError(f"{what}: malformed ({type(error).__name__}: {error})") from None


def made(given: Any) -> Any:
    """The value that `kept` gave.

    Raises:
        ValueError, TypeError, KeyError, ElbowroomError: it is none.
    """
    if isinstance(given, list):
        return tuple(made(item) for item in given)
    if not isinstance(given, dict):
        return given
    if "float" in given:
        return float(given["float"])
    if "array" in given:
        return _array(given)
    if "map" in given:
        return {made(key): made(item) for key, item in given["map"]}
    return _value(KINDS[given["of"]], given["fields"])


def _value(kind: Any, fields: Mapping[str, Any]) -> Any:
    """A value of a kind: checked when it is made, and then just as it was kept, where making it rounded something."""
    given = {name: made(fields[name]) for name in _names(kind) if name in fields}
    value = kind(**given)
    if hasattr(kind, "_fields"):
        return value
    for name, item in given.items():
        if kept(getattr(value, name)) != fields[name]:
            if isinstance(item, np.ndarray):
                item.setflags(write=False)
            object.__setattr__(value, name, item)
    return value


def _names(kind: Any) -> tuple[str, ...]:
    """Of what a value of a kind is made."""
    if hasattr(kind, "_fields"):
        return tuple(kind._fields)
    return tuple(field.name for field in dataclasses.fields(kind) if field.init)


def _array(given: Mapping[str, Any]) -> Any:
    try:
        data = base64.b64decode(given["data"], validate=True)
    except binascii.Error as error:
        raise ValueError(str(error)) from None
    return np.frombuffer(data, ARRAYS[given["array"]]).reshape(given["shape"]).copy()
