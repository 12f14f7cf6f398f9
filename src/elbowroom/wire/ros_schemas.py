"""Definitions of the messages of ROS 2 that are written, field by field, with those that they are made of."""

COMPRESSED_IMAGE = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
JOINT_STATE = "sensor_msgs/msg/JointState"
TF = "tf2_msgs/msg/TFMessage"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
LOG = "rcl_interfaces/msg/Log"
STRING = "std_msgs/msg/String"

_TIME = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec"
_HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id"
_LINE = "\n" + "=" * 80 + "\n"


def _joined(own: str, *parts: str) -> bytes:
    return (_LINE.join([own.strip(), *(part.strip() for part in parts)]) + "\n").encode()


SCHEMAS: dict[str, bytes] = {
    COMPRESSED_IMAGE: _joined("std_msgs/Header header\nstring format\nuint8[] data", _HEADER, _TIME),
    CAMERA_INFO: _joined(
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
        "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
        "sensor_msgs/RegionOfInterest roi",
        _HEADER,
        _TIME,
        "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
        "bool do_rectify",
    ),
    JOINT_STATE: _joined(
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort",
        _HEADER,
        _TIME,
    ),
    TF: _joined(
        "geometry_msgs/TransformStamped[] transforms",
        "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/Transform transform",
        "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
        "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z",
        "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w",
        _HEADER,
        _TIME,
    ),
    DIAGNOSTICS: _joined(
        "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status",
        "MSG: diagnostic_msgs/DiagnosticStatus\nbyte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n"
        "string name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values",
        "MSG: diagnostic_msgs/KeyValue\nstring key\nstring value",
        _HEADER,
        _TIME,
    ),
    LOG: _joined(
        "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\nbuiltin_interfaces/Time stamp\n"
        "uint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line",
        _TIME,
    ),
    STRING: _joined("string data"),
}
"""By the type's name; as `ros2msg` of MCAP has them."""
