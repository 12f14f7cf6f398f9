"""What one camera measures and others see through: a pose or a lens that cannot be meant."""
