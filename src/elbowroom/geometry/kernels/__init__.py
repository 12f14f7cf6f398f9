"""What kernels of all stages share: bits of voxels, a pinhole camera, noise of depth, rigid transforms, neighbours."""

from elbowroom.geometry.kernels.library import load_unparsed

load_unparsed()
