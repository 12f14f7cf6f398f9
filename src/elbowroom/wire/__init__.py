"""Bytes of the files that a run leaves: packed depth, messages of ROS 2, MCAP, and the chain that holds its records."""
