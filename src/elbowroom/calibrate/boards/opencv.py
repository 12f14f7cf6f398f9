"""OpenCV, where it is installed: only `calibrate` needs it."""

from types import ModuleType

from elbowroom.errors import CalibrationError


def opencv() -> ModuleType:
    """The module `cv2`.

    Raises:
        CalibrationError: it is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise CalibrationError(
            "boards are found with OpenCV, which is not installed; pip install 'elbowroom[calibrate]'"
        ) from None
    return cv2
