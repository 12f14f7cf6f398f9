"""Any URDF is a machine: an arm of two joints beside a post, and a path through its joint space.

    python examples/04_own_robot.py

Here the free space is a volume that comes from elsewhere. `er.reconstruct` would make it from images.
"""

import math
from pathlib import Path

import numpy as np

import elbowroom as er

URDF = """<robot name="arm">
  <link name="foot"><collision><geometry><cylinder radius="0.08" length="0.3"/></geometry></collision></link>
  <link name="upper">
    <collision><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.08 0.08"/></geometry></collision>
  </link>
  <link name="fore">
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.06 0.06"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="foot"/><child link="upper"/><origin xyz="0 0 0.25"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" effort="1" velocity="1"/>
  </joint>
</robot>"""

path = Path("04_arm.urdf")
path.write_text(URDF)
world_from_base = np.eye(4)
world_from_base[2, 3] = 0.15  # the foot's middle stands 15 cm above the floor
machine = er.Machine.from_urdf(path, world_from_base=world_from_base)
print(f"{machine.name}: joints {', '.join(machine.joint_names)}, links {', '.join(machine.link_names)}")

grid = er.VoxelGrid.covering((-1.2, -1.2, 0), (1.2, 1.2, 0.8), 0.02)
occupied = np.zeros(grid.shape, dtype=bool)
post = grid.index_of((0.5, 0.6, 0.0))
occupied[post[0] - 2 : post[0] + 2, post[1] - 2 : post[1] + 2, :] = True  # a post of 8 cm

joints = {"shoulder": 0.0, "elbow": 0.0}
space = er.FreeSpace.from_occupied(grid, occupied).without(machine, joints)  # its own body is not in its way

# at 0.5 rad/s, and 0.4 s from full speed to rest
stop = er.braking_distance(0.5, 0.4)
for direction in (+1, -1):
    turn = er.Motion("shoulder", direction, braking_distance=stop, reach=math.radians(80))
    verdict = er.check_motion(space, machine, joints, turn)
    print(
        f"shoulder {direction:+d}: {math.degrees(verdict.free_travel):.1f} degrees of 80, "
        f"{verdict.level.name.lower()}, {verdict.cause.value}"
    )

# folded first, it passes the post
folded = {"shoulder": 0.0, "elbow": -2.4}
fold_and_turn = er.JointPath([folded, {**folded, "shoulder": 1.4}], braking_distance=stop)
verdict = er.check_motion(space, machine, joints, fold_and_turn)
print(
    f"fold, then turn: {verdict.level.name.lower()}, {verdict.free_travel:.2f} {verdict.free_travel_unit} of the path"
)
