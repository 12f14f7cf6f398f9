"""What the cameras of a layout cost: sensors, mounts, and cables along the room's axes to the hub."""

from typing import Any

import numpy as np

from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedCamera
from elbowroom.placement.bill import bill
from elbowroom.placement.candidates import Candidate, Mount, cable_m


def bill_of(ground: Ground, layout: Layout) -> list[dict[str, Any]]:
    """A row for each camera and one for all, as `placement.bill` has it.

    A camera within a millimetre of a mount that the site lists hangs there, at its price.

    Args:
        ground: its prices.
        layout: all cameras of which have to be bought.
    """
    return bill([_bought(ground, placed) for placed in layout.cameras])


def price_of(ground: Ground, layout: Layout) -> float:
    """Of all cameras together.

    Args:
        ground, layout: as of `bill_of`.
    """
    return float(bill_of(ground, layout)[-1]["price"])


def _bought(ground: Ground, placed: PlacedCamera) -> Candidate:
    sensor = next((one for one in ground.sensors if one.name == placed.sensor), None)
    mount = _mount(ground, placed)
    cable = mount.cable_m * ground.prices.cable_per_m
    price = 0.0 if sensor is None else sensor.price
    if sensor is None:
        sensor = type(ground.sensors[0])(placed.sensor, placed.camera, 0.0)
    return Candidate(placed.camera, mount, sensor, price + mount.price + cable, cable)


def _mount(ground: Ground, placed: PlacedCamera) -> Mount:
    """Where it hangs, and what that costs."""
    given, at = ground.site.entry.placement, placed.camera.centre_in_world
    price, cable = ground.prices.mount, cable_m(at, ground.prices)
    for entry in () if given is None else given.mounts:
        if np.linalg.norm(at - np.array(entry.position_m)) < 1e-3:
            price = price if entry.price is None else entry.price
            cable = cable if entry.cable_m is None else entry.cable_m
            return Mount(entry.name, at, price, cable)
    return Mount(placed.name, at, price, cable)
