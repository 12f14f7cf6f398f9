"""How right in rooms: against exact truth, exact geometry and real recordings."""
