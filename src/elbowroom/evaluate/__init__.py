"""Every claim as a figure that anyone can reproduce: against exact truth, exact geometry and real recordings."""
