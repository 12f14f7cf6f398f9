"""How a camera sees: focal lengths, principal point, distortion, and scale and bias of its depth, from a board."""

from elbowroom.calibrate.intrinsics.coverage import advice, cells_seen
from elbowroom.calibrate.intrinsics.lens_model import LensModel
from elbowroom.calibrate.intrinsics.solve import FoundIntrinsics, solve_intrinsics

__all__ = ["FoundIntrinsics", "LensModel", "advice", "cells_seen", "solve_intrinsics"]
