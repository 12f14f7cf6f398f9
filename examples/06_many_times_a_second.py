"""The pass that is done many times a second: newest frames in, a verdict for each motion out.

    python examples/06_many_times_a_second.py

`elbowroom monitor` does this, with a screen, rows and pictures about it.
"""

import itertools

from elbowroom.monitor import Cycle
from elbowroom.site import Site
from elbowroom.sources.room import open_room

room = open_room(Site.simulated_room(), cameras=18)
machine, motions = room.machine_and_motions()
cycle = Cycle(room.grid, room.cameras, machine, motions, room.terms)

for snapshot in itertools.islice(room.source, 5):
    result = cycle.run(snapshot)
    worst = min(result.verdicts, key=lambda verdict: verdict.free_travel)
    print(
        f"cycle {result.sequence}: {result.cycle_ms:5.1f} ms, level {result.level.name}; "
        f"least room: {worst.motion.name}, {worst.free_travel:.3f} {worst.free_travel_unit}, {worst.cause.value}"
    )
