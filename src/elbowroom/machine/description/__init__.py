"""What a robot description says: a URDF read element by element, each fault with its place."""
