"""What is wrong with a camera, a stream or the machine, and why."""
