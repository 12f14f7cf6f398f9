"""What stands beside the monitor and may only stop: the words of a decision, the latch on disk, the watchdog, its outputs.

Nothing here needs NumPy, Numba or any stage, so that the watchdog is a small process of its own that no fault of these can end.
"""
