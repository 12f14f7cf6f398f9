"""Cameras brought to agree on what they see in common, each no farther than its covariance allows."""
