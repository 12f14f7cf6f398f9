"""What the joint least squares looks for, and where in a step each unknown stands."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.extrinsics.anchor import BoardAnchor, CameraAnchor
from elbowroom.geometry.twist import moved

Array = NDArray[np.float64]


@dataclass(eq=False)
class State:
    """Where everything is thought to be.

    Args:
        cameras: world_from_camera by name.
        boards: world_from_board by pose.
        depth_errors: bias [m] and scale by name of the camera, shape (2,); only of those with depth.
    """

    cameras: dict[str, Array]
    boards: dict[int, Array]
    depth_errors: dict[str, Array]

    def moved(self, step: Array, index: "Index") -> "State":
        """The state after a step, shape (n,)."""
        return State(
            {
                name: moved(pose, step[index.cameras[name]]) if name in index.cameras else pose
                for name, pose in self.cameras.items()
            },
            {
                pose: moved(at, step[index.boards[pose]]) if pose in index.boards else at
                for pose, at in self.boards.items()
            },
            {name: error + step[index.depths[name]] for name, error in self.depth_errors.items()},
        )


class Index:
    """Where in a step each unknown stands; what is held has no place.

    Args:
        state: all of them.
        held: what does not move; None: everything does.
    """

    def __init__(self, state: State, held: BoardAnchor | CameraAnchor | None) -> None:
        at = 0
        self.cameras: dict[str, slice] = {}
        self.boards: dict[int, slice] = {}
        self.depths: dict[str, slice] = {}
        for name in state.cameras:
            if not (isinstance(held, CameraAnchor) and held.camera == name):
                self.cameras[name], at = slice(at, at + 6), at + 6
        for pose in state.boards:
            if not (isinstance(held, BoardAnchor) and held.pose == pose):
                self.boards[pose], at = slice(at, at + 6), at + 6
        for name in state.depth_errors:
            self.depths[name], at = slice(at, at + 2), at + 2
        self.size = at
