"""The drift watch measured in the simulated room: knocks named, false alarms, wrong joints, its time.

Frames come at 30 Hz. Everything is rendered anew with noise of its own; the reference is commissioned in the same room
while people walk and the machine moves.
"""

from elbowroom.evaluate.drift.rows import drift_rows

__all__ = ["drift_rows"]
