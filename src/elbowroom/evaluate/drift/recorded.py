"""The watch over a recording of real cameras before which things are moved."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from elbowroom.evaluate.drift.knocks import KNOCKS
from elbowroom.evaluate.drift.scene import Tell
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.sensing import Snapshot
from elbowroom.simulate.knock import Knock
from elbowroom.site import Site
from elbowroom.sources import moments


def recorded_rows(site: Site, tell: Tell, passes: int = 90) -> Iterator[dict[str, Any]]:
    """A recording of fixed cameras before which things are moved, played again and again.

    Every other moment is commissioned, and all are heard. A knock cannot be made afterwards; instead the first camera's
    reference is that of a camera that stood a degree or 2 cm elsewhere, exactly, since its surfaces are planes.

    Args:
        site: with a recording and no machine.
        tell: called with what is done next, in words.
        passes: how many moments are heard.

    Yields:
        Rows of `knock`, `named` and `others_named`, `said` and its two sigmas, as for simulated knocks.
    """
    tell(f"real: {site.name}")
    cameras, seen = site.cameras(), [moment.frames for moment in moments(site)]
    commissioning = Commissioning(cameras, None, len(seen[::2]))
    for frames in seen[::2]:
        commissioning.add(Snapshot(frames))
    references = commissioning.references()
    for name, knock in {"none": Knock(""), **KNOCKS}.items():
        watch = Watch(cameras, [commissioned_elsewhere(references[0], knock), *references[1:]])
        for k in range(passes):
            health = watch.hear(Snapshot(seen[k % len(seen)], now_ns=k))
            if health.stops:
                break
        shift = watch.shift_of(cameras[0].name)
        turns = any(knock.turn_rad)
        yield {
            "kind": "recorded",
            "site": site.name,
            "knock": name,
            "named": cameras[0].name in health.stops,
            "others_named": len(set(health.stops) - {cameras[0].name}),
            "passes": k + 1,
            "unit": None if shift is None else "deg" if turns else "mm",
            "said": None if shift is None else shift.turn_deg if turns else shift.move_mm,
            "two_sigma": None
            if shift is None
            else 2 * (shift.turn_sigma_deg if turns else shift.move_sigma_mm),
        }


def commissioned_elsewhere(reference: CameraReference, knock: Knock) -> CameraReference:
    """What a reference would be, had its camera stood elsewhere: the same planes, met by the same rays from there.

    Args:
        reference: of the camera where it stands.
        knock: that would bring it there, in its own axes.
    """
    rotation, move = knock.old_from_new[:3, :3], knock.old_from_new[:3, 3]
    normal = reference.normal @ rotation
    direction = reference.points_in_camera / reference.depth_m[:, None]
    towards = np.sum(normal * direction, axis=1)
    depth = np.sum(reference.normal * (reference.points_in_camera - move), axis=1) / towards
    kept = (depth > 0) & (towards < -0.1)
    return replace(
        reference,
        pixel=reference.pixel[kept],
        depth_m=depth[kept],
        sigma_m=reference.sigma_m[kept],
        ray=reference.ray[kept],
        normal=normal[kept],
    )
