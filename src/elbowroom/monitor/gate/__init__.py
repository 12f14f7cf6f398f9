"""The gate: what verdicts and faults become for whoever drives the machine. It may hold back, never start or speed up."""
