"""Beside the monitor, and able to stop alone: the words of a decision, the latch on disk, the watchdog, its outputs.

Nothing here needs NumPy, Numba or any stage: the watchdog is a small process that no fault of these can end.
"""
