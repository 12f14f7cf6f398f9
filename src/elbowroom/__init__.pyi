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
    Cause as Cause,
    Distances as Distances,
    JointPath as JointPath,
    Level as Level,
    Motion as Motion,
    Verdict as Verdict,
    braking_distance as braking_distance,
    check_motion as check_motion,
    check_motions as check_motions,
    joint_motions as joint_motions,
    link_distances as link_distances,
    most_cautious as most_cautious,
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
