"""A look at the values that come in: at the first moments at all images, then at one camera's every few passes."""

from collections.abc import Mapping, Sequence

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.sensing import Snapshot
from elbowroom.sensing.values import Thinned, found_in, look_at_setting, thinned, together
from elbowroom.sensing.values.inverse import KIND as DISPARITY
from elbowroom.sensing.values.unit import KIND as UNIT

FIRST = 3
"""At so many moments all images are looked at."""
LASTING = (UNIT, DISPARITY)
"""What no sensor changes while it runs is asked at those moments alone."""
EVERY = 4
"""Then one image in so many passes: a hundredth of a pass that takes 40 ms."""


class ValuesLook:
    """Units, sentinels, masks, lenses and places that cannot be meant so (`Look`).

    What is found of an image is said until that camera is looked at again, and what is found of several until all are
    looked at again; of units, lenses and places, to the end. A moment without frames does not count.

    Args:
        grid: the watched box.
        cameras: of the room.
        units_m: metres per unit of the files that images are read from, by camera; none of those that are not files.
        said: what was found before, of the site; it is said to the end.
    """

    name = "values"

    def __init__(
        self,
        grid: VoxelGrid,
        cameras: Sequence[DepthCamera],
        units_m: Mapping[str, float],
        said: Sequence[Finding] = (),
    ) -> None:
        self._grid, self._cameras, self._units_m = grid, {camera.name: camera for camera in cameras}, units_m
        self._setting = (*said, *look_at_setting(grid, cameras))
        self._of_all: list[Finding] = []
        self._of_one: dict[str, list[Finding]] = {}
        self._heard = 0

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """What is found by now."""
        if any(finding.stops for finding in self._setting):
            return self._setting
        if snapshot.frames:
            self._look(snapshot)
            self._heard += 1
        return (*self._setting, *self._told())

    def _told(self) -> Sequence[Finding]:
        """What is said of the images by now."""
        found = [*self._of_all, *(finding for each in self._of_one.values() for finding in each)]
        return together(found, len(self._cameras))

    def _look(self, snapshot: Snapshot) -> None:
        """At all images at the first moments, and while something stops that may pass; else at one in turn."""
        turn, rest = divmod(self._heard - FIRST, EVERY)
        if turn < 0:
            self._look_at_all(snapshot)
        elif rest == 0 and any(each.stops and each.kind not in LASTING for each in self._told()):
            lasting = [finding for finding in self._told() if finding.kind in LASTING]
            self._look_at_all(snapshot)
            told = {finding.kind for finding in lasting}
            self._of_all = [*lasting, *(each for each in self._of_all if each.kind not in told)]
        elif rest == 0:
            self._look_at_one(snapshot, turn)

    def _look_at_all(self, snapshot: Snapshot) -> None:
        images = [
            self._thinned(frame.camera, snapshot)
            for frame in snapshot.frames
            if frame.camera in self._cameras
        ]
        found = found_in(images, self._grid)
        self._of_one = {
            image.camera.name: [each for each in found if each.about == (image.camera.name,)]
            for image in images
        }
        self._of_all = [each for each in found if len(each.about) > 1]

    def _look_at_one(self, snapshot: Snapshot, turn: int) -> None:
        names = [frame.camera for frame in snapshot.frames if frame.camera in self._cameras]
        if names:
            name = names[turn % len(names)]
            kept = [each for each in self._of_one.get(name, ()) if each.kind in LASTING]
            self._of_one[name] = kept + found_in([self._thinned(name, snapshot)], self._grid, of_all=False)

    def _thinned(self, name: str, snapshot: Snapshot) -> Thinned:
        frame = next(frame for frame in snapshot.frames if frame.camera == name)
        return thinned(self._cameras[name], frame, self._units_m.get(name))
