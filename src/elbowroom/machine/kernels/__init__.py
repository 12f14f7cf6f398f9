"""The machine in voxels and in images, in compiled loops."""
