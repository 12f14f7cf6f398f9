"""The drift watch: what stands still is commissioned, and what no longer stands there is found."""
