"""Views of voxels in compiled loops."""
