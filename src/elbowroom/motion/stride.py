"""How fast the points of each link go at most, and how far they go while the machine brakes: wherever it is."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.machine.kernels.body import FIXED, SLIDES
from elbowroom.motion.kernels.mover import bound_speeds
from elbowroom.motion.skin import skin_of


def greatest_strides(machine: Machine, rates: Mapping[str, float], voxel_size_m: float) -> dict[str, float]:
    """By checked link, the most that any of its points moves while each joint moves by its rate, all at once.

    With full speeds as rates it is a speed, with braking distances a distance. A joint that turns moves a point by its
    rate times the distance from its axis: that of the link's own joint is measured, those farther up are bounded by the
    lengths of the chain, so it holds wherever the machine is.

    Args:
        machine: the machine.
        rates: of joints by name [m or rad, per whatever is asked]; a joint that is missing does not move.
        voxel_size_m: edge of a voxel, for the samples that stand for links [m].

    Returns:
        [m, per whatever is asked], infinite where a joint turns what another one slides without limit.
    """
    tree = machine.tree
    by_column = np.array([abs(rates.get(name, 0.0)) for name in machine.joint_names] + [0.0])
    by_row = by_column[tree.column] * np.abs(tree.multiplier)
    by_row[tree.kind == FIXED] = 0.0
    skin = skin_of(machine, voxel_size_m)
    middle = machine.positions(_some_pose(machine))
    placed = machine.world_from_link_array(middle[None])[0]
    strides = bound_speeds(tree, by_row, _greatest_lengths(machine), placed, skin)
    rows = np.unique(skin.link)
    return {machine.link_names[row]: float(strides[skin.link == row].max()) for row in rows}


def _some_pose(machine: Machine) -> dict[str, float]:
    """Within all limits."""
    return {joint.name: float(np.clip(0.0, joint.lower, joint.upper)) for joint in machine.joints}


def _greatest_lengths(machine: Machine) -> NDArray[np.float64]:
    """The farthest that each link's frame can be from its parent's [m], shape (n_links,)."""
    tree = machine.tree
    lengths = np.linalg.norm(tree.parent_from_joint[:, :3, 3], axis=1)
    far = [max(abs(joint.lower), abs(joint.upper)) for joint in machine.joints] + [0.0]
    slides = tree.kind == SLIDES
    reach = np.array(far)[tree.column[slides]] * np.abs(tree.multiplier[slides])
    lengths[slides] += reach + np.abs(tree.offset[slides])
    return np.asarray(lengths)
