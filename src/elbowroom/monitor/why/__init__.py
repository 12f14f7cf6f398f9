"""Why a motion may not go on: by how much, and what would change it."""
