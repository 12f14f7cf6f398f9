import numpy as np

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import body_words, ceiling_c_arm
from elbowroom.motion import blocks_in_reach, joint_motions

GRID = VoxelGrid((-2, -2, 0), (40, 40, 25), 0.1)
SPEEDS = {"long": 0.15, "larm": 0.2094, "propeller": 0.4363, "carc": 0.4363}
JOINTS = {"long": 0.1, "larm": 0.3, "propeller": -0.2, "carc": 0.1}


def test_all_that_the_body_covers_on_its_motions_is_in_focus():
    machine = ceiling_c_arm()
    motions = joint_motions(machine, SPEEDS, 0.5)
    focus = blocks_in_reach(GRID, machine, JOINTS, motions)
    assert focus.shape == (bits.word_count(GRID),)
    checked = set(machine.unchecked_links)
    for motion in motions:
        for share in np.linspace(0, 1, 7):
            moved = JOINTS | {
                motion.joint: JOINTS[motion.joint] + motion.direction * share * motion.looked_at
            }
            covered = body_words(machine, moved, GRID, growth_m=0.025) != 0
            lower_part = bits.pack(_below(2.3), GRID) != 0
            assert not (covered & lower_part & ~focus).any(), (motion.name, share, checked)


def _below(height_m):
    mask = np.zeros(GRID.shape, dtype=bool)
    mask[:, :, : round(height_m / GRID.voxel_size_m)] = True
    return mask


def test_a_far_corner_of_the_room_is_out_of_focus():
    machine = ceiling_c_arm()
    focus = blocks_in_reach(GRID, machine, JOINTS, joint_motions(machine, SPEEDS, 0.5))
    corner = np.zeros(GRID.shape, dtype=bool)
    corner[0, 0, 0] = True
    assert not focus[bits.pack(corner, GRID) != 0].any() and 0 < focus.mean() < 1
