"""The control service: a reset and a held signal for whoever knows the token, and how the monitor is, by HTTP.

It runs in a small process of its own and imports no NumPy; the monitor writes it a line after each pass, and never
waits.
"""
