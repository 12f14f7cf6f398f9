"""A depth image on disk that has not been read."""

from pathlib import Path
from typing import NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame
from elbowroom.site.site import Site
from elbowroom.sources.depth_image import check_depth_image, read_depth_image


class Stored(Protocol):
    """An image within a larger file."""

    @property
    def in_metres(self) -> bool:
        """Whether it holds metres, and not whole numbers."""

    def content(self) -> bytes:
        """What is stored, byte for byte."""

    def check(self, camera: DepthCamera) -> None:
        """Makes sure that it can be the camera's, decodes nothing; raises as `Image.read`."""

    def pixels(self, camera: DepthCamera) -> NDArray[np.uint16] | NDArray[np.float32]:
        """Whole numbers, or metres, shape (height, width); raises as `Image.read`."""


class Image(NamedTuple):
    """An image on disk that has not been read.

    Args:
        camera: that took it.
        stamp_ns: when [ns]; None: it has no time.
        path: of the file; of an image within one, the file with a name for the image.
        scale_m: metres per unit; images that hold metres have no unit.
        bias_m: what is added to each depth after that [m].
        stored: where it lies within a larger file; None: it has its own.
    """

    camera: DepthCamera
    stamp_ns: int | None
    path: Path
    scale_m: float
    bias_m: float = 0.0
    stored: Stored | None = None

    @classmethod
    def of(
        cls, site: Site, camera: DepthCamera, stamp_ns: int | None, path: Path, stored: Stored | None = None
    ) -> Self:
        """An image with the scale and bias that the site says of its camera.

        Args:
            site: of the recording.
            camera, stamp_ns, path, stored: as of the class.
        """
        name = camera.name
        return cls(camera, stamp_ns, path, site.depth_scale_m(name), site.depth_bias_m(name), stored)

    @property
    def unit_m(self) -> float | None:
        """Metres per unit, where depths are whole multiples of it."""
        in_metres = self.stored is not None and self.stored.in_metres
        return self.scale_m if self.bias_m == 0 and not in_metres else None

    def read(self) -> DepthFrame:
        """The frame.

        Raises:
            FrameError: the file is not what its camera delivers.
            BagError: the message is malformed.
        """
        pixels = self._pixels()
        if pixels.dtype == np.uint16:
            raw = pixels.astype(np.uint16, copy=False)
            return DepthFrame.from_raw(
                self.camera.name, self.stamp_ns, raw, scale_m=self.scale_m, bias_m=self.bias_m
            )
        return DepthFrame(self.camera.name, self.stamp_ns, _biased(pixels, self.bias_m))

    def raw(self) -> NDArray[np.uint16]:
        """The sensor's whole numbers, shape (height, width); raises as `read`, and where it holds metres."""
        pixels = self._pixels()
        if pixels.dtype != np.uint16:
            raise FrameError(f"{self.path}: holds metres (32FC1), and whole numbers are asked for")
        return pixels.astype(np.uint16, copy=False)

    def check(self) -> None:
        """Looks at the image's header alone; raises as `read` would."""
        if self.stored is not None:
            self.stored.check(self.camera)
        else:
            check_depth_image(self.path, self.camera.width, self.camera.height)

    def content(self) -> bytes:
        """What is stored, byte for byte."""
        return self.path.read_bytes() if self.stored is None else self.stored.content()

    def _pixels(self) -> NDArray[np.uint16] | NDArray[np.float32]:
        if self.stored is not None:
            return self.stored.pixels(self.camera)
        return read_depth_image(self.path, self.camera.width, self.camera.height)


def _biased(metres: NDArray[np.uint16] | NDArray[np.float32], bias_m: float) -> NDArray[np.float32]:
    """Metres with the bias of their camera; what falls to zero or below by it is no return."""
    given = metres.astype(np.float32, copy=False)
    there = np.isfinite(given) & (given > 0)
    return np.where(there, np.maximum(given + np.float32(bias_m), 0), np.float32(0))
