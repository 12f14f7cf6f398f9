"""Values are looked at: whether images, lenses and poses that read as valid can be meant so; each look a file."""

from elbowroom.sensing.values.images import found_in, look_at_images
from elbowroom.sensing.values.setting import look_at_setting
from elbowroom.sensing.values.thinned import Thinned, thinned
from elbowroom.sensing.values.together import together

__all__ = ["Thinned", "found_in", "look_at_images", "look_at_setting", "thinned", "together"]
