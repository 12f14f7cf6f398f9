"""Ways to know less of a room: frames missing, pixels without a return, wider margins, old frames."""

from dataclasses import replace

import numpy as np

from elbowroom.geometry.margin import Margin
from elbowroom.sensing import DepthFrame

WAYS = (
    "lose a frame",
    "lose pixels",
    "widen sigmas",
    "widen bias",
    "widen lateral",
    "widen range",
    "grow old",
)
NOW, AGE = 1_000_000_000, 100_000_000


def weakened(rng, frames, margin, ways):
    """Frames and margin that say less, by some of WAYS. Frames are young at NOW for the age limit AGE."""
    frames = list(frames)
    if "lose a frame" in ways and frames:
        del frames[rng.integers(len(frames))]
    if "lose pixels" in ways:
        frames = [with_holes(rng, frame) for frame in frames]
    if "grow old" in ways and frames:
        n = rng.integers(len(frames))
        frames[n] = DepthFrame(frames[n].camera, NOW - AGE - 1, frames[n].depth_m)
    more = {}
    if "widen sigmas" in ways:
        more["sigmas"] = margin.sigmas + rng.choice((0.01, 0.5, 3))
    if "widen bias" in ways:
        more["bias_m"] = margin.bias_m + rng.choice((1e-6, 1e-3, 0.03))
    if "widen lateral" in ways:
        more["lateral_px"] = margin.lateral_px + rng.choice((0.01, 0.3, 1.0))
    if "widen range" in ways:
        more["range_linear"] = margin.range_linear + rng.choice((1e-6, 0.01))
        more["range_quadratic"] = margin.range_quadratic + rng.choice((1e-6, 0.01))
    return frames, replace(margin, **more)


def with_holes(rng, frame):
    """The frame with single pixels and a patch that are no return, of any kind."""
    depth = frame.depth_m.copy()
    depth[rng.random(depth.shape) < rng.choice((0.0, 0.002, 0.05))] = rng.choice((0, np.nan, np.inf, -1))
    v, u = (int(rng.integers(n)) for n in depth.shape)
    depth[v : v + int(rng.integers(12)), u : u + int(rng.integers(12))] = 0
    return DepthFrame(frame.camera, frame.stamp_ns, depth)


def some_margin(rng):
    """A margin with any of its parts."""
    return Margin(
        sigmas=float(rng.choice((0, 1, 3))),
        bias_m=float(rng.choice((0, 0.004))),
        lateral_px=float(rng.choice((0, 0.5, 0.8))),
        range_linear=float(rng.choice((0, 0.002))),
        range_quadratic=float(rng.choice((0, 0.001))),
    )
