"""What the watch adds to a pass of the monitor."""

import time
from typing import Any

import numpy as np

from elbowroom.evaluate.drift.scene import PERIOD_S, Tell, commissioned, frames_of
from elbowroom.sensing import DepthFrame, Snapshot


def time_row(tell: Tell, passes: int = 100) -> dict[str, Any]:
    """What the watch adds to a pass: 21 cameras of 640 x 480 pixels, body included."""
    tell("time of a pass")
    scene = commissioned("kinect_v1", 640, 480)
    shown = [scene.room.at(20.0 + 0.5 * k) for k in range(4)]
    frames = [frames_of(scene.cameras, moment, k) for k, moment in enumerate(shown)]
    watch, times, cpu = scene.watch(), [], []
    for k in range(passes + 12):
        stamp = int(k * PERIOD_S * 1e9)
        now = [DepthFrame(f.camera, stamp, f.depth_m) for f in frames[k % 4]]
        begun, worked = time.perf_counter(), time.process_time()
        watch.hear(Snapshot.taken(now, shown[k % 4].joints, stamp))
        times.append((time.perf_counter() - begun) * 1e3)
        cpu.append((time.process_time() - worked) * 1e3)
    p50, p99, worst = np.percentile(times[12:], (50, 99, 100))
    return {
        "kind": "watch time",
        **scene.words,
        "passes": passes,
        "median_ms": float(p50),
        "p99_ms": float(p99),
        "max_ms": float(worst),
        "cpu_median_ms": float(np.median(cpu[12:])),
    }
