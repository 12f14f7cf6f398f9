"""Files of triangles, each read as its format means it: units, axes, mirrored nodes; or refused by name."""
