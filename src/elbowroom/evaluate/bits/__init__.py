"""Check sums of free space and verdicts: whether a change of the code changed a bit."""
