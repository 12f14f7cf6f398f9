"""A depth image that lies in a bag, and when the recorder got it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.depth import check_depth, depth_of
from elbowroom.sources.bags.storage import Stored
from elbowroom.sources.layouts.image import Image


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """A depth image within a bag (`layouts.image.Stored`).

    Args:
        bag: opened.
        topic: of the image.
        stored: where it lies.
        name: of the message, for errors.
        in_metres: whether it holds metres.
    """

    bag: Bag
    topic: str
    stored: Stored
    name: str
    in_metres: bool

    def content(self) -> bytes:
        """The message, byte for byte."""
        return self.bag.read(self.stored)

    def check(self, camera: DepthCamera) -> None:
        """Looks at what the message says of its image; raises as `pixels`."""
        size = camera.width, camera.height
        check_depth(self.bag.topics[self.topic].type, self.content(), self.name, size)

    def pixels(self, camera: DepthCamera) -> NDArray[np.uint16] | NDArray[np.float32]:
        """Whole numbers, or metres, shape (height, width).

        Raises:
            BagError, FrameError: malformed, or not what the camera delivers.
        """
        size = camera.width, camera.height
        return depth_of(self.bag.topics[self.topic].type, self.content(), self.name, size)


class Arrival(NamedTuple):
    """An image, and when the recorder got it.

    Args:
        received_ns: [ns, the recorder's clock].
        image: not read yet.
    """

    received_ns: int
    image: Image
