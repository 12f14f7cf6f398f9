"""How right calibration is."""
