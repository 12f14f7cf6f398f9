"""Attacks on the control service while a monitor runs: what is let in, and how much later passes are."""
