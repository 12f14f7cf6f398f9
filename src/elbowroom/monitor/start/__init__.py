"""What is done before the first cycle: kernels compiled on all cores, the watch set, a cycle done once."""
