"""Where are the cameras? From depth images of a board that is carried through the room; and how sure that is.

    python examples/09_calibration.py

The capture is simulated, so that the true poses are known. A capture of your own is laid out in the same way.
"""

from pathlib import Path

import numpy as np

from elbowroom.calibrate import sightings
from elbowroom.calibrate.extrinsics import solve_extrinsics
from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.calibrate.simulated import read_truth
from elbowroom.cli import run
from elbowroom.site import Site

out = Path("capture")
run(["calibrate", "simulate", "board", "--out", str(out), "--cameras", "4", "--poses", "10", "--seed", "2"])

site = Site.load(out / "site.yaml")
seen = sightings(site)
print(f"the board was found in {len(seen.views)} images of {seen.poses} poses")

found = solve_extrinsics(site.cameras(), seen.board, seen.views, anchor_of(site))
truth = read_truth(out)["cameras"]
for each in found.cameras:
    true_centre = np.array(truth[each.camera.name]["world_from_camera"])[:3, 3]
    off_mm = 1e3 * np.linalg.norm(each.camera.centre_in_world - true_centre)
    sigma_mm = 1e3 * np.sqrt(np.trace(each.covariance[3:, 3:]))
    print(
        f"{each.camera.name}: {off_mm:.1f} mm from where it truly is; it says {sigma_mm:.1f} mm (one sigma)"
    )

print(
    "the same, with margins that follow and a page: elbowroom calibrate extrinsics capture --out calibrated.yaml"
)
