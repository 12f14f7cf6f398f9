"""The thesis' experiments by name, in the order of the page."""

from elbowroom.evaluate.thesis import calibration, more, motions, reconstruction, scale
from elbowroom.evaluate.thesis.part import Part

PARTS: dict[str, Part] = {
    module.PART.name: module.PART for module in (reconstruction, motions, calibration, scale, more)
}
