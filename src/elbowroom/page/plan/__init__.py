"""Planning with your hands: a room, cameras that can be dragged, and what that changes."""
