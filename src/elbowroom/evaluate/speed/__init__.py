"""How fast, in time and memory."""
