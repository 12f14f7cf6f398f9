"""Bags of ROS 2 without ROS: what `ros2 bag record` writes, in both storages, read as far as it goes."""
