"""What is wrong with a site, kind by kind: values that read as valid and cannot be meant so.

A kind is a function of a good scene and random numbers. Another kind is another entry of `WRONG`.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.looks.scene import MOST, Codes, Scene
from elbowroom.geometry import DepthCamera, Intrinsics

Change = Callable[[Scene, np.random.Generator], Scene]


@dataclass(frozen=True, slots=True)
class Wrong:
    """A kind of wrong input.

    Args:
        change: a good scene made wrong.
        kinds: findings of these kinds name it; none: any will do.
        stops: whether it must stop.
    """

    change: Change
    kinds: tuple[str, ...] = ()
    stops: bool = True


def of_codes(change: Callable[[Codes, float, np.random.Generator], NDArray[np.number]]) -> Change:
    """Every image changed, pixel by pixel.

    Args:
        change: of raw codes, metres per unit, and random numbers; what it gives is cut to 16 bits.
    """

    def changed(scene: Scene, rng: np.random.Generator) -> Scene:
        codes = {
            name: np.clip(np.rint(change(raw, scene.units_m[name], rng)), 0, 65535).astype(np.uint16)
            for name, raw in scene.codes.items()
        }
        return replace(scene, codes=codes)

    return changed


def of_cameras(change: Callable[[DepthCamera, np.random.Generator], DepthCamera]) -> Change:
    """Every camera changed.

    Args:
        change: of a camera, and random numbers.
    """
    return lambda scene, rng: replace(scene, cameras=[change(camera, rng) for camera in scene.cameras])


def other_unit(factor: float) -> Change:
    """The site says a unit so many times the true one.

    Args:
        factor: above 0.
    """
    return lambda scene, rng: replace(
        scene, units_m={name: unit * factor for name, unit in scene.units_m.items()}
    )


def sentinel(value_m: float | None = None, code: int | None = None, share: float = 0.08) -> Change:
    """Pixels in patches that have no return are one number.

    Args:
        value_m: the number [m], or
        code: as it stands in the file; neither: all kinds of codes at the end of the range.
        share: of the pixels, about.
    """

    def change(raw: Codes, unit: float, rng: np.random.Generator) -> NDArray[np.floating]:
        said = raw.astype(float)
        lost = _patches(raw.shape, share, rng) | (raw == 0)
        if code is None and value_m is None:
            return np.where(lost, rng.integers(65400, MOST + 1, raw.shape), said)
        return np.where(lost, code if code is not None else min((value_m or 0) / unit, MOST), said)

    make = of_codes(change)

    def without_range(scene: Scene, rng: np.random.Generator) -> Scene:
        """A greatest range in the site file would make it harmless."""
        return make(replace(scene, cameras=[replace(c, max_depth_m=np.inf) for c in scene.cameras]), rng)

    return without_range


def noisy(change: Change, sigma_m: float = 0.002) -> Change:
    """A change of images that scatter, as those of sensors do.

    Args:
        change: after that.
        sigma_m: standard deviation [m].
    """

    def changed(scene: Scene, rng: np.random.Generator) -> Scene:
        scatter = of_codes(
            lambda raw, unit, r: np.where(raw > 0, raw + r.normal(0, sigma_m / unit, raw.shape), 0)
        )
        return change(scatter(scene, rng), rng)

    return changed


def _patches(shape: tuple[int, ...], share: float, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Round patches, as windows, screens and black cloth are."""
    rows, columns = np.mgrid[0 : shape[0], 0 : shape[1]]
    lost = np.zeros(shape, dtype=np.bool_)
    while lost.mean() < share:
        row, column = rng.uniform(0, shape[0]), rng.uniform(0, shape[1])
        radius = rng.uniform(0.03, 0.2) * shape[0]
        lost |= (rows - row) ** 2 + (columns - column) ** 2 < radius**2
    return lost


def _placed(camera: DepthCamera, factor: float) -> DepthCamera:
    pose = camera.world_from_camera.copy()
    pose[:3, 3] *= factor
    return replace(camera, world_from_camera=pose)


def _lens(camera: DepthCamera, **changes: float) -> DepthCamera:
    intrinsics = Intrinsics(**{**asdict(camera.intrinsics), **changes})
    return replace(camera, intrinsics=intrinsics)


def _full_size(camera: DepthCamera, factor: float) -> DepthCamera:
    k = camera.intrinsics
    return _lens(
        camera,
        fx=k.fx * factor,
        fy=k.fy * factor,
        cx=(k.cx + 0.5) * factor - 0.5,
        cy=(k.cy + 0.5) * factor - 0.5,
    )


def _unit_image(camera: DepthCamera) -> DepthCamera:
    k = camera.intrinsics
    return _lens(camera, fx=k.fx / camera.width, fy=k.fy / camera.height, cx=0.5, cy=0.5)


def _scaled(raw: Codes, of: NDArray[np.floating], most: float) -> NDArray[np.floating]:
    """A picture from 0 to a greatest value; no return stays 0."""
    return np.where(raw > 0, of / of[raw > 0].max() * most, 0)


def _inverse(raw: Codes) -> NDArray[np.floating]:
    return 1.0 / np.maximum(raw, 1)


UNIT, SENTINEL = ("unit",), ("sentinel",)
WRONG: Mapping[str, Wrong] = {
    "quarter millimetres as millimetres": Wrong(other_unit(4), UNIT),
    "tenths of a millimetre as millimetres": Wrong(other_unit(10), UNIT),
    "micrometres as millimetres": Wrong(other_unit(1000), ("unit", "metres")),
    "millimetres as tenths": Wrong(other_unit(0.1), UNIT),
    "millimetres as micrometres": Wrong(other_unit(0.001), ("unit", "no returns")),
    "bits shifted by 3": Wrong(
        of_codes(lambda raw, unit, rng: np.minimum(raw.astype(float) * 8, 65528 * (raw > 0))), ()
    ),
    "bits shifted by 4": Wrong(
        of_codes(lambda raw, unit, rng: np.minimum(raw.astype(float) * 16, 65520 * (raw > 0))), ()
    ),
    "bytes exchanged": Wrong(of_codes(lambda raw, unit, rng: raw.byteswap()), ("byte order", "no surfaces")),
    "no return is 10 m": Wrong(sentinel(value_m=10.0), SENTINEL),
    "no return is 2 m": Wrong(noisy(sentinel(value_m=2.0)), SENTINEL),
    "no return is 2047 mm": Wrong(noisy(sentinel(value_m=2.047)), SENTINEL),
    "no return is 65533": Wrong(sentinel(code=65533), SENTINEL),
    "no return is 32767": Wrong(sentinel(code=32767), ("sentinel", "unit")),
    "no return is random codes above 65000": Wrong(
        sentinel(code=None),
        SENTINEL,
    ),
    "a mask of 0 and 255": Wrong(
        of_codes(lambda raw, unit, rng: np.where(raw > np.median(raw), 255, 0)), ("mask",)
    ),
    "an 8-bit picture": Wrong(
        of_codes(lambda raw, unit, rng: _scaled(raw, raw.astype(float), 255)), ("mask", "no returns")
    ),
    "disparity of 16 bits": Wrong(
        of_codes(lambda raw, unit, rng: _scaled(raw, _inverse(raw), 60000)), ("disparity", "no returns")
    ),
    "disparity of 12 bits": Wrong(
        of_codes(lambda raw, unit, rng: _scaled(raw, _inverse(raw), 4095)), ("disparity",)
    ),
    "all black": Wrong(of_codes(lambda raw, unit, rng: raw * 0.0), ("no returns",)),
    "all one number": Wrong(
        of_codes(lambda raw, unit, rng: raw * 0.0 + 20.0 / unit), ("sentinel", "unit", "no returns")
    ),
    "noise": Wrong(of_codes(lambda raw, unit, rng: rng.integers(1, 65535, raw.shape)), ("no surfaces",)),
    "poses in millimetres": Wrong(of_cameras(lambda camera, rng: _placed(camera, 1000)), ("pose",)),
    "poses in centimetres": Wrong(of_cameras(lambda camera, rng: _placed(camera, 100)), ("pose",)),
    "poses in inches": Wrong(of_cameras(lambda camera, rng: _placed(camera, 1 / 0.0254)), ("pose",)),
    "lens of twice the size": Wrong(
        of_cameras(lambda camera, rng: _full_size(camera, 2)), ("principal point",)
    ),
    "lens of four times the size": Wrong(
        of_cameras(lambda camera, rng: _full_size(camera, 4)), ("principal point",)
    ),
    "lens of half the size": Wrong(
        of_cameras(lambda camera, rng: _full_size(camera, 0.5)), ("principal point",)
    ),
    "lens of an image of size 1": Wrong(
        of_cameras(lambda camera, rng: _unit_image(camera)), ("field of view",)
    ),
    "focal length in millimetres": Wrong(
        of_cameras(lambda camera, rng: _lens(camera, fx=1.93, fy=1.93)), ("field of view",)
    ),
    "cx and cy exchanged": Wrong(
        of_cameras(lambda camera, rng: _lens(camera, cx=camera.intrinsics.cy, cy=camera.intrinsics.cx)),
        ("principal point",),
    ),
}
"""By name. What can be told only by what cameras contradict is `evaluate contradictions`'."""
