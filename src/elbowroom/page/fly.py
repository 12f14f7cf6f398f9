"""A browser's view flown to a place."""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

STEPS, STEP_S = 10, 0.03
AWAY_M = 1.3
"""From so far a place is looked at [m]."""


def client_of(guarded: Any, token: str) -> Any | None:
    """The client of viser that a browser's scene is; None: there is none.

    Args:
        guarded: the server.
        token: by which the scene was opened.
    """
    wanted = f"/scene/{token}"
    clients = guarded.viser.get_clients()
    for number, path in guarded.client_paths().items():
        if path.partition("?")[0] == wanted and number in clients:
            return clients[number]
    return None


def fly_to(client: Any, place: NDArray[np.float64]) -> None:
    """Turns and moves a view until it looks at a place from near, from where it was.

    Args:
        client: of viser.
        place: shape (3,), world frame [m].
    """
    start, looked = np.array(client.camera.position), np.array(client.camera.look_at)
    away = start - place
    length = float(np.linalg.norm(away))
    direction = away / length if length > 1e-6 else np.array([0.6, -0.6, 0.5])
    end = place + AWAY_M * direction
    for step in range(1, STEPS + 1):
        share = 0.5 - 0.5 * np.cos(np.pi * step / STEPS)
        with client.atomic():
            client.camera.position = start + share * (end - start)
            client.camera.look_at = looked + share * (place - looked)
        time.sleep(STEP_S)
