"""A hand at arms whose collision geometry is larger than they are."""
