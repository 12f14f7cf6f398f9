"""May the machine move, how far, and why not farther? Every joint of the C-arm in both directions.

python examples/03_verdict_and_why.py
"""

import elbowroom as er
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.simulate.inside import hung_clear

room = InterventionRoom()
machine = room.machine
grid = er.VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05)
hung = wall_cameras(21, height_m=(2.4, 0.4), width=320, height=240, noise=NOISE_PRESETS["tof"])
cameras = hung_clear(hung, room.solids)  # one that would hang inside a cabinet hangs beside it
moment = room.at(time_s=3.0)
known = er.Margin(lateral_px=0.0)  # simulated cameras are where they say; real ones want 0.5 px
frames = render(cameras, moment)
space = er.reconstruct(grid, cameras, frames, machine=machine, joints=moment.joints, margin=known)

# S, the braking distance, follows from full speed and the time to rest; stop within S, slow down within 2 S
speeds = {"long": 0.15, "larm": 0.21, "propeller": 0.44, "carc": 0.44}  # [m/s] or [rad/s]
motions = er.joint_motions(machine, speeds, braking_times=0.5)
verdicts = er.check_motions(space, machine, moment.joints, motions)

for verdict in verdicts:
    motion = verdict.motion
    way = f"{verdict.free_travel:.3f} {verdict.free_travel_unit}"
    print(
        f"{motion.joint:9s} {'-+'[motion.direction > 0]}  {verdict.level.name:10s} {way:10s} {verdict.cause.value}"
    )

# the one that wins where all joints may move at once
worst = er.most_cautious(verdicts)
print()
print(f"most cautious: {worst.level.value}")
if worst.place_in_world is not None:
    print(f"{worst.link} meets:")
    print(space.explain(worst.place_in_world))
