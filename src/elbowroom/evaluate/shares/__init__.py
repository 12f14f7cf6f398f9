"""Work shared out among processes and computers, and kept for going on."""
