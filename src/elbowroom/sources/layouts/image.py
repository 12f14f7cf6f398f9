"""A depth image on disk that has not been read."""

from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame
from elbowroom.site.site import Site
from elbowroom.sources.depth_image import check_depth_image, read_depth_image


class Image(NamedTuple):
    """An image on disk that has not been read.

    Args:
        camera: that took it.
        stamp_ns: when [ns]; None: it has no time.
        path: of the file.
        scale_m: metres per unit.
        bias_m: what is added to each depth after that [m].
    """

    camera: DepthCamera
    stamp_ns: int | None
    path: Path
    scale_m: float
    bias_m: float = 0.0

    @classmethod
    def of(cls, site: Site, camera: DepthCamera, stamp_ns: int | None, path: Path) -> Self:
        """An image with the scale and bias that the site says of its camera.

        Args:
            site: of the recording.
            camera, stamp_ns, path: as of the class.
        """
        name = camera.name
        return cls(camera, stamp_ns, path, site.depth_scale_m(name), site.depth_bias_m(name))

    @property
    def unit_m(self) -> float | None:
        """Metres per unit, where depths are whole multiples of it."""
        return self.scale_m if self.bias_m == 0 else None

    def read(self) -> DepthFrame:
        """The frame.

        Raises:
            FrameError: the file is not what its camera delivers.
        """
        return DepthFrame.from_raw(
            self.camera.name, self.stamp_ns, self.raw(), scale_m=self.scale_m, bias_m=self.bias_m
        )

    def raw(self) -> NDArray[np.uint16]:
        """The sensor's whole numbers, shape (height, width); raises as `read`."""
        return read_depth_image(self.path, self.camera.width, self.camera.height)

    def check(self) -> None:
        """Looks at the file's header alone; raises FrameError as `read` would."""
        check_depth_image(self.path, self.camera.width, self.camera.height)
