"""The closed loop: a machine that its verdicts stop, people who walk past it, and what was really in the way."""
