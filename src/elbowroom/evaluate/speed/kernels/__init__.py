"""What computers are compared by."""
