"""Packages that only some commands need: imported when they are used, missed with the command that installs them."""

from importlib import import_module
from typing import Any

from elbowroom.errors import PackageError

PACKAGES = {
    "coal": ("exact mesh distance needs coal", "evaluate"),
    "cv2": ("calibration needs OpenCV", "calibrate"),
    "distributed": ("a cluster needs Dask", "cluster"),
    "matplotlib": ("charts need Matplotlib", "evaluate"),
    "ortools": ("finding a placement needs CP-SAT of OR-Tools", "placement"),
    "xacro": ("expanding a xacro file needs xacro", "xacro"),
    "small_gicp": ("calibration by the machine needs small_gicp", "calibrate"),
}
"""What needs each of them, and the extra of elbowroom that brings it."""


def package(name: str) -> Any:
    """An optional package, or a module of one.

    Args:
        name: as it is imported, such as "ortools.sat.python.cp_model"; the first word is one of `PACKAGES`.

    Raises:
        PackageError: it cannot be imported; says what to install.
    """
    need, extra = PACKAGES[name.partition(".")[0]]
    try:
        return import_module(name)
    except ImportError as error:
        raise PackageError(
            f"{need}, which cannot be imported ({error}); pip install 'elbowroom[{extra}]'"
        ) from error
