"""What is wrong with the program or its input is one of these; what is true of the world is a value.

    ElbowroomError
    ├── InputError           an argument or a value in a file is not usable
    │   ├── GridError        an empty grid, a grid larger than memory
    │   ├── CameraError      intrinsics, pose, an unknown or doubled camera
    │   ├── FrameError       a depth image that is not what its camera delivers
    │   ├── MachineError     a URDF, a mesh, a joint that is unknown or out of its limits
    │   ├── JointsError      joints over time that are malformed, or not known at the time that is asked for
    │   ├── SiteError        a site file or a recording's folder
    │   ├── BagError         a rosbag2 or MCAP file, or a message in it, that is not what it says it is
    │   ├── CalibrationError a board, a capture, or what was seen in it does not fix a pose
    │   │   └── NoResultError  something was found that cannot be taken for a result
    │   └── ImplausibleError values that read as valid and cannot be meant so: a unit, a lens, a pose, a sentinel
    ├── EvidenceError        evidence that cannot be merged or resolved
    └── PackageError         an optional package is not installed

Four are warnings, not errors. `PoseWarning`: a pose was a little off a rotation and was brought to the nearest one.
`ValueWarning`: something that was given reads as valid, but is most likely not meant so.
`MachineWarning`: a URDF has a slip that passes; the message says how it is taken.
`UnfinishedWarning`: Ctrl-C or an error ended what wrote a file; the message says where is kept what there was.
"""


class ElbowroomError(Exception):
    """Base of every error that elbowroom raises itself."""


class InputError(ElbowroomError, ValueError):
    """An argument or a value in a file is not usable; the message says which, what came, what is allowed."""


class GridError(InputError):
    """A voxel grid that is empty, malformed or too large for this machine's memory."""


class CameraError(InputError):
    """Intrinsics or a pose that no camera can have, an unknown camera, or one named twice."""


class FrameError(InputError):
    """A depth image that its camera cannot have delivered."""


class MachineError(InputError):
    """A URDF, mesh, link or joint that is missing, unknown or out of its limits."""


class JointsError(InputError):
    """A record of joints that cannot be used, or that does not know where the machine was at a time."""


class SiteError(InputError):
    """A site file or a recording's folder that cannot be used."""


class BagError(InputError):
    """A rosbag2 or MCAP file, or a message in it, that cannot be read; the text names the topic and what came."""


class CalibrationError(InputError):
    """A board or a capture from which a pose cannot be had; the message says what to capture instead."""


class NoResultError(CalibrationError):
    """What a calibration found is none: a camera moved by metres, or hardly known; the message says what it may be."""


class ImplausibleError(InputError):
    """Values that read as valid and cannot be meant so; the message says what was found and what it most likely is."""


class EvidenceError(ElbowroomError):
    """Evidence of unlike grids, of a camera named twice, or of a kind that the rule cannot be decided from."""


class PackageError(ElbowroomError):
    """A package that only some commands need is not installed; the message says how to install it."""


class MachineWarning(UserWarning):
    """A URDF has a slip that other readers pass over, and so does this one; the message names its place."""


class PoseWarning(UserWarning):
    """A pose was off a rigid transform by less than 1e-3 and was brought to the nearest rotation."""


class UnfinishedWarning(UserWarning):
    """Ctrl-C or an error ended a run that wrote a file; what it had until then is kept aside."""


class ValueWarning(UserWarning):
    """Something that was given is most likely not meant so; judging goes on. The message is a finding's text."""
