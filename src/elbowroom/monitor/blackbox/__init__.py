"""What a run was given and what it decided, kept: in a file, or of the last minute in memory; and judged again."""
