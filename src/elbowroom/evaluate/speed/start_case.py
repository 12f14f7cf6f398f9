"""One start in a process of its own: a script that imports nothing before the clock runs.

    python -P start_case.py alone|machine|readme

Prints the milliseconds that importing the package, making the values and the first call took, as JSON.
"""

import json
import sys
import time


def _now() -> tuple[float, float]:
    """Wall clock and this process's processor time [s]."""
    return time.perf_counter(), time.process_time()


def main(what: str) -> None:
    """Free space from one image: of the bare room, with the C-arm, or as in the README, with it in voxels of 2 cm."""
    begun = _now()
    import elbowroom as er

    imported = _now()
    import numpy as np

    camera = er.DepthCamera(
        name="north",
        width=640,
        height=480,
        world_from_camera=np.eye(4),
        intrinsics=er.Intrinsics(fx=320, fy=320, cx=319.5, cy=239.5),
        noise=er.NoiseModel(constant_m=0.0015, linear=0.0, quadratic=0.00025),
    )
    frame = er.DepthFrame(camera="north", stamp_ns=0, depth_m=np.full((480, 640), 2.4))
    grid = er.VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.02 if what == "readme" else 0.05)
    machine, joints = None, None
    if what != "alone":
        machine = er.ceiling_c_arm()
        joints = {"long": 0.0, "larm": 0.2, "propeller": 0.0, "carc": 0.0}
    made = _now()
    er.reconstruct(grid, [camera], [frame], machine, joints)
    first = _now()
    er.reconstruct(grid, [camera], [frame], machine, joints)
    second = _now()
    steps = {
        "import": (begun, imported),
        "values": (imported, made),
        "first": (made, first),
        "second": (first, second),
        "to_answer": (begun, first),
    }
    spent = {f"{name}_ms": 1e3 * (end[0] - start[0]) for name, (start, end) in steps.items()}
    cpu = {f"{name}_cpu_ms": 1e3 * (end[1] - start[1]) for name, (start, end) in steps.items()}
    print(json.dumps(spent | cpu))


if __name__ == "__main__":
    main(sys.argv[1])
