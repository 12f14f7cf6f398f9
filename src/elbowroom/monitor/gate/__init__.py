"""The gate: what verdicts and faults become for whoever drives the machine. It holds back, and never speeds up."""
