"""Where should cameras hang? The share of a room that enough of them see, before any is bought.

python examples/08_where_cameras_hang.py
"""

import elbowroom as er
from elbowroom.placement import FixedRoom, Requirement, verify, worst_places
from elbowroom.simulate import InterventionRoom, wall_cameras
from elbowroom.simulate.inside import hung_clear

grid = er.VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.1)
room = InterventionRoom(people=False)
fixed = FixedRoom(room.solids)
wanted = Requirement(views=3, angle_deg=100.0)  # thesis 3.3: then three things must stand in the way at once

for count in (6, 9, 12, 21):
    cameras = hung_clear(wall_cameras(count, height_m=(2.4, 0.4)), room.solids)
    found = verify(grid, cameras, fixed, wanted)
    print(
        f"{count:2d} cameras: {found.valid_pct:5.1f} % of the room have {wanted.words}; "
        f"{100 - found.seen_pct(1):.1f} % nobody sees"
    )

print("\nworst places of the last:")
for place in worst_places(found)[:3]:
    print(f"  {place}")
