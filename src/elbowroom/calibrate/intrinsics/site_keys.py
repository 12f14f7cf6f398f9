"""What a site file says of a camera once its intrinsics are known."""

from typing import Any

import numpy as np

from elbowroom.calibrate.intrinsics.solve import FoundIntrinsics
from elbowroom.site import Site
from elbowroom.site.update import lens_entry

SIGNIFICANT = 2.0
"""Scale and bias of depth are written where one of them is off by so many sigmas."""


def changed_keys(site: Site, found: FoundIntrinsics) -> dict[str, Any]:
    """The keys of one camera that change; measured = scale * true + bias, solved for what is true.

    Args:
        site: as it was when the capture was made.
        found: what it gave.
    """
    entry = lens_entry(found.camera.intrinsics)
    off = np.abs([found.depth_scale - 1, found.depth_bias_m]) > SIGNIFICANT * np.array(found.depth_sigma)
    if off.any():
        name = found.camera.name
        entry["depth_scale_m"] = float(f"{site.depth_scale_m(name) / found.depth_scale:.8g}")
        bias = (site.depth_bias_m(name) - found.depth_bias_m) / found.depth_scale
        entry["depth_bias_m"] = round(bias, 6)
    return entry
