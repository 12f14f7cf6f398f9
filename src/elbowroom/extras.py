"""Packages that only some commands need: imported when they are used, missed with the command that installs them."""

import re
import shlex
import sys
from importlib import import_module, metadata
from typing import Any

from elbowroom.errors import PackageError

PACKAGES = {
    "coal": ("exact mesh distance needs coal", "evaluate"),
    "cv2": ("calibration needs OpenCV", "calibrate"),
    "cryptography": ("the Foxglove face needs cryptography", "foxglove"),
    "distributed": ("a cluster needs Dask", "cluster"),
    "foxglove": ("the Foxglove face needs foxglove-sdk", "foxglove"),
    "lz4": ("reading this bag, whose chunks are compressed with lz4, needs lz4", "bag"),
    "matplotlib": ("charts need Matplotlib", "evaluate"),
    "numba_cuda": ("running on a GPU needs numba-cuda", "cuda"),
    "ortools": ("finding a placement needs CP-SAT of OR-Tools", "placement"),
    "pymodbus": ("the Modbus output needs pymodbus", "modbus"),
    "small_gicp": ("calibration by the machine needs small_gicp", "calibrate"),
    "viser": ("the page needs viser", "page"),
    "websockets": ("the page needs websockets", "page"),
    "xacro": ("expanding a xacro file needs xacro", "xacro"),
    "zstandard": (
        "what is compressed with zstd, as some bags and all recordings of a run are, needs zstandard",
        "bag",
    ),
}
"""What needs each of them, and the extra of elbowroom that names its version."""


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
            f"{need}, which cannot be imported ({error}); install what {extra} needs: {install_command(extra)}"
        ) from error


def install_command(extra: str) -> str:
    """What installs the packages of an extra, into the environment that this program runs in.

    It names the packages and not the extra, so that it works from a checkout and from wherever else.

    Args:
        extra: of elbowroom, such as "placement".
    """
    lines = metadata.requires("elbowroom") or []
    wanted = [
        line.partition(";")[0].strip() for line in lines if re.search(rf"extra == ['\"]{extra}['\"]", line)
    ]
    return shlex.join([sys.executable, "-m", "pip", "install", *wanted])
