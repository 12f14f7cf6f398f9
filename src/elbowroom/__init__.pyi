# The public names of elbowroom and where each is at home. Type checkers read this file and so does `__init__.py`: a
# name stands here and nowhere else.

from elbowroom.errors import ElbowroomError as ElbowroomError
from elbowroom.geometry import (
    DepthCamera as DepthCamera,
    Intrinsics as Intrinsics,
    VoxelGrid as VoxelGrid,
)
from elbowroom.machine import (
    Contact as Contact,
    Machine as Machine,
    Part as Part,
    Stand as Stand,
    Zone as Zone,
)
from elbowroom.machine.c_arm import ceiling_c_arm as ceiling_c_arm
from elbowroom.motion import (
    Braking as Braking,
    Cause as Cause,
    Distances as Distances,
    JointPath as JointPath,
    Level as Level,
    MachineState as MachineState,
    Motion as Motion,
    PathVerdict as PathVerdict,
    Trajectory as Trajectory,
    Verdict as Verdict,
    braking_distance as braking_distance,
    check_motion as check_motion,
    check_motions as check_motions,
    check_path as check_path,
    check_stop as check_stop,
    joint_motions as joint_motions,
    longest_safe_prefix as longest_safe_prefix,
    machine_speed as machine_speed,
    link_distances as link_distances,
    most_cautious as most_cautious,
    read_path as read_path,
)
from elbowroom.reconstruct import (
    Evidence as Evidence,
    FreeSpace as FreeSpace,
    carve as carve,
    merge as merge,
    reconstruct as reconstruct,
    resolve as resolve,
    warm_up as warm_up,
)
from elbowroom.sensing import (
    NOISE_PRESETS as NOISE_PRESETS,
    DepthFrame as DepthFrame,
    JointRecord as JointRecord,
    Margin as Margin,
    NoiseModel as NoiseModel,
)
from elbowroom.site import Site as Site
