"""How long a tally of the watch takes to decide by chance, exactly."""

import numpy as np


def mean_run_length(limit: int, share: float) -> float:
    """Frames until a `Tally` decides, on average, if each says yes with one probability, whatever others say.

    Exact: mean absorption time of its Markov chain. Frames of real rooms hang together, so this is no promise; it says
    how rare wrong frames have to be.

    Args:
        limit: of the tally.
        share: probability that a frame says yes, between 0 and 1, neither included.
    """
    # time from score s to s + 1, by where a no leads: t[s] = 1 + (1 - share) (t[down] + ... + t[s]), solved for t[s]
    up = np.zeros(limit)
    for s in range(limit):
        down = max(s - 2, 0)
        up[s] = (1 + (1 - share) * up[down:s].sum()) / share
    return float(up.sum())
